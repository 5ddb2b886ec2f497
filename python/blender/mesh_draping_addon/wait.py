"""The drape itself: on a thread, while Blender stays responsive; Escape cancels it."""

import threading

import bpy
import mesh_draping as md

from . import transfer

#: Seconds between two looks at the thread.
LOOK_EVERY = 0.1


class Running:
    """A drape on a thread of its own. It touches nothing of Blender: what it takes was read before."""

    def __init__(self, given: dict) -> None:
        self.result: "md.Result | None" = None
        self.error: "Exception | None" = None
        self.share = 0.0
        self._run: "md.Drape | None" = None
        self._is_cancelled = False
        self._thread = threading.Thread(target=self._work, args=(given,), daemon=True)
        self._thread.start()

    def _work(self, given: dict) -> None:
        try:
            self._run = md.Drape(**given)
            if self._is_cancelled:
                self._run.cancel()
            self.result = self._run.run(self._show)
        except Exception as error:  # It is told where the thread is waited for.
            self.error = error

    def _show(self, step: md.Step) -> None:
        self.share = (step.iteration + 1) / step.n_iterations

    def cancel(self) -> None:
        """Ends it after the iteration that goes on."""
        self._is_cancelled = True
        if self._run is not None:
            self._run.cancel()

    @property
    def is_over(self) -> bool:
        """Whether there is a result or an error."""
        return not self._thread.is_alive()

    def wait(self) -> None:
        """Until it is over."""
        self._thread.join()


class DRAPE_OT_drape(bpy.types.Operator):
    """Drape the source over the target; Escape cancels"""

    bl_idname = "mesh_draping.drape"
    bl_label = "Drape"
    bl_options = {"REGISTER", "UNDO"}

    _running: "Running | None" = None
    _timer = None

    def invoke(self, context, _event):
        if not self._start(context):
            return {"CANCELLED"}
        manager = context.window_manager
        self._timer = manager.event_timer_add(LOOK_EVERY, window=context.window)
        manager.progress_begin(0, 100)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        """For scripts: waits for the end."""
        if not self._start(context):
            return {"CANCELLED"}
        self._running.wait()
        return self._end(context)

    def modal(self, context, event):
        if event.type == "ESC":
            self._running.cancel()
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        percent = 100 * self._running.share
        context.window_manager.progress_update(percent)
        context.workspace.status_text_set(f"Draping: {percent:.0f} %    Esc: cancel")
        if not self._running.is_over:
            return {"RUNNING_MODAL"}
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)
        return self._end(context)

    def _start(self, context) -> bool:
        try:
            self._running = Running(transfer.inputs(context.scene.mesh_draping))
        except md.Error as error:
            self.report({"ERROR"}, str(error))
            return False
        return True

    def _end(self, context):
        running, settings = self._running, context.scene.mesh_draping
        if running.error is not None:
            kind = "INFO" if isinstance(running.error, md.Cancelled) else "ERROR"
            self.report({kind}, str(running.error))
            return {"CANCELLED"}
        transfer.put_result(settings, running.result)
        settings.told = transfer.told(running.result)
        for note in running.result.notes:
            self.report({"INFO"}, note)
        self.report({"INFO"}, settings.told)
        return {"FINISHED"}


def register() -> None:
    bpy.utils.register_class(DRAPE_OT_drape)


def unregister() -> None:
    bpy.utils.unregister_class(DRAPE_OT_drape)

"""Marks: by selected vertices, by clicking, from files; and the parts of the source."""

import os
import tempfile

import bpy
import mesh_draping as md
from bpy.props import EnumProperty, IntProperty, StringProperty
from bpy_extras import view3d_utils
from bpy_extras.io_utils import ExportHelper, ImportHelper

from . import marks, transfer


def settings_of(context):
    return context.scene.mesh_draping


class WithPair:
    """Needs a source and a target."""

    @classmethod
    def poll(cls, context):
        settings = settings_of(context)
        return settings.source is not None and settings.target is not None


class DRAPE_OT_mark_vertices(WithPair, bpy.types.Operator):
    """Mark the selected vertex of the source, of the target, or of both at once (edit mode)"""

    bl_idname = "mesh_draping.mark_vertices"
    bl_label = "Mark selected vertices"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(name="Name", description="Where none is given, the next one")

    def execute(self, context):
        settings = settings_of(context)
        name = self.name or marks.next_name(settings)
        n_marked = 0
        for side, thing in (("source", settings.source), ("target", settings.target)):
            thing.update_from_editmode()
            chosen = [v for v in thing.data.vertices if v.select and not v.hide]
            if len(chosen) == 1:
                marks.put(settings, name, side, chosen[0].co, chosen[0].index)
                n_marked += 1
        if n_marked == 0:
            self.report({"ERROR"}, "select one vertex of the source, of the target, or of each")
            return {"CANCELLED"}
        return {"FINISHED"}


class DRAPE_OT_eyedropper(WithPair, bpy.types.Operator):
    """Click places: first on the source, then on the target; Escape ends"""

    bl_idname = "mesh_draping.eyedropper"
    bl_label = "Click places"
    bl_options = {"REGISTER", "UNDO"}

    def invoke(self, context, _event):
        context.window.cursor_modal_set("EYEDROPPER")
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type in {"ESC", "RIGHTMOUSE", "RET"}:
            context.window.cursor_modal_restore()
            return {"FINISHED"}
        if event.type == "LEFTMOUSE" and event.value == "PRESS":
            at = (event.mouse_region_x, event.mouse_region_y)
            region, view = context.region, context.region_data
            origin = view3d_utils.region_2d_to_origin_3d(region, view, at)
            self.pick(context, origin, view3d_utils.region_2d_to_vector_3d(region, view, at))
            return {"RUNNING_MODAL"}
        return {"PASS_THROUGH"}

    @staticmethod
    def pick(context, origin, direction) -> bool:
        """Marks where a ray hits the source or the target; whether it hit one."""
        settings = settings_of(context)
        graph = context.evaluated_depsgraph_get()
        is_hit, point, _, _, thing, _ = context.scene.ray_cast(graph, origin, direction)
        sides = {settings.source: "source", settings.target: "target"}
        if not is_hit or thing not in sides:
            return False
        local = thing.matrix_world.inverted() @ point
        marks.put(settings, marks.next_name(settings), sides[thing], local)
        return True


class DRAPE_OT_read_marks(WithPair, bpy.types.Operator, ImportHelper):
    """Read a landmark file of any form"""

    bl_idname = "mesh_draping.read_marks"
    bl_label = "Read landmarks"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(default="*.json;*.txt", options={"HIDDEN"})

    def execute(self, context):
        settings = settings_of(context)
        try:
            pair = md.Source(settings.source), transfer.target(settings.target)
            n_curves = marks.put_entries(settings, md.landmarks.read(self.filepath, *pair))
            if n_curves > 0:
                self.report({"WARNING"}, f"{n_curves} curves are left out: marks are empties, which are places")
        except md.Error as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class DRAPE_OT_write_marks(WithPair, bpy.types.Operator, ExportHelper):
    """Write the marks as a landmark file"""

    bl_idname = "mesh_draping.write_marks"
    bl_label = "Write landmarks"

    filename_ext = ".json"

    def execute(self, context):
        folder, name = os.path.split(self.filepath)
        # Written beside it and put in its place: a file is there whole or not at all.
        with tempfile.NamedTemporaryFile("w", dir=folder, prefix=name, delete=False) as file:
            file.write(marks.to_json(settings_of(context)))
        os.replace(file.name, self.filepath)
        return {"FINISHED"}


class DRAPE_OT_check_marks(WithPair, bpy.types.Operator):
    """Tell which marks look wrong: off the surface, doubled, exchanged, mirrored, far from where the others expect them"""

    bl_idname = "mesh_draping.check_marks"
    bl_label = "Check marks"

    def execute(self, context):
        settings = settings_of(context)
        try:
            pair = md.Source(settings.source), transfer.target(settings.target)
            findings = md.landmarks.check(marks.entries(settings), *pair).findings
        except md.Error as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for finding in findings:
            self.report({"WARNING"}, finding)
        if not findings:
            self.report({"INFO"}, "nothing looks wrong")
        return {"FINISHED"}


class DRAPE_OT_parts(bpy.types.Operator):
    """Add or remove a vertex group that is treated in its own way"""

    bl_idname = "mesh_draping.parts"
    bl_label = "Parts"
    bl_options = {"REGISTER", "UNDO"}

    action: EnumProperty(items=[("add", "Add", ""), ("remove", "Remove", "")])
    index: IntProperty()

    def execute(self, context):
        parts = settings_of(context).parts
        if self.action == "add":
            parts.add()
        else:
            parts.remove(self.index)
        return {"FINISHED"}


CLASSES = (
    DRAPE_OT_mark_vertices,
    DRAPE_OT_eyedropper,
    DRAPE_OT_read_marks,
    DRAPE_OT_write_marks,
    DRAPE_OT_check_marks,
    DRAPE_OT_parts,
)


def register() -> None:
    for kind in CLASSES:
        bpy.utils.register_class(kind)


def unregister() -> None:
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)

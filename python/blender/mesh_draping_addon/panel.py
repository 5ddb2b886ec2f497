"""The panel: 3D view, side bar, tab Drape."""

import bpy


class DRAPE_PT_panel(bpy.types.Panel):
    """Drape a mesh over a shape"""

    bl_label = "Mesh Draping"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Drape"

    def draw(self, context):
        settings, layout = context.scene.mesh_draping, self.layout
        layout.use_property_split = True
        layout.prop(settings, "source")
        layout.prop(settings, "target")
        self.draw_marks(settings, layout.box())
        self.draw_parts(settings, layout.box())
        for name in ("preset", "overlap", "seed", "result"):
            layout.prop(settings, name)
        layout.operator("mesh_draping.drape", icon="MOD_CLOTH")
        if settings.told:
            layout.label(text=settings.told)

    @staticmethod
    def draw_marks(settings, box) -> None:
        n = len(settings.marks.objects) if settings.marks else 0
        box.label(text=f"Landmarks: {n // 2} pairs")
        box.operator("mesh_draping.eyedropper", icon="EYEDROPPER")
        box.operator("mesh_draping.mark_vertices", icon="VERTEXSEL")
        box.prop(settings, "marks", text="Empties")
        row = box.row(align=True)
        row.operator("mesh_draping.read_marks", text="Read")
        row.operator("mesh_draping.write_marks", text="Write")
        row.operator("mesh_draping.check_marks", text="Check")

    @staticmethod
    def draw_parts(settings, box) -> None:
        box.label(text="Eyes, teeth, mouths")
        for k, part in enumerate(settings.parts):
            row = box.row(align=True)
            if settings.source is not None:
                row.prop_search(part, "group", settings.source, "vertex_groups", text="")
            row.prop(part, "treatment", text="")
            remove = row.operator("mesh_draping.parts", text="", icon="X")
            remove.action, remove.index = "remove", k
        box.operator("mesh_draping.parts", text="Add a vertex group", icon="ADD").action = "add"


def register() -> None:
    bpy.utils.register_class(DRAPE_PT_panel)


def unregister() -> None:
    bpy.utils.unregister_class(DRAPE_PT_panel)

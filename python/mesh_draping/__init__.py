"""Drape a mesh you like over a shape you want: same vertices, same faces, same UVs, in the target's shape.

    import mesh_draping as md
    result = md.drape("horse.obj", "wolf.obj", "pairs.json")
    result.write("draped.obj")

=============================================  ==========================================
to                                             call
=============================================  ==========================================
drape a mesh over a shape                      :func:`drape`
drape step by step, look, change, cancel       :class:`Drape`
read, check, mirror, suggest landmarks         :mod:`mesh_draping.landmarks`
deform by landmarks only                       :func:`init`
judge any result                               :func:`metrics`
send other points along                        :meth:`Result.warp`, :class:`Warp`
list presets and settings                      :func:`presets`, :func:`settings`
try it on creatures whose truth is known       :mod:`mesh_draping.bench`
drape thousands                                :mod:`mesh_draping.farm`
=============================================  ==========================================

A *mesh* is a path, an object of ``trimesh``, a mesh or mesh object of Blender, a pair ``(vertices, faces)``, or a
:class:`Source` or :class:`Target` made of one of these. Vertices are an array of shape (n, 3) in any unit; faces are an
integer array of shape (m, 3) or (m, 4), or a list of polygons of any arity. Rows count from 0. A target may also be an
array of points of shape (n, 3), or ``(points, None, normals)``.

What goes in keeps its units and axes; results are in the units and axes of the target. The same inputs, settings and seed
give the same bits on any number of threads, and the same as ``drape transfer``.
"""

from . import bench, landmarks
from ._drape import Drape, Result, Step, drape
from ._judge import Judgement, init, metrics
from ._native import Cancelled, Error
from ._settings import presets, settings
from ._shapes import Source, Target
from ._warp import Warp

__all__ = [
    "Cancelled",
    "Drape",
    "Error",
    "Judgement",
    "Result",
    "Source",
    "Step",
    "Target",
    "Warp",
    "bench",
    "drape",
    "init",
    "landmarks",
    "metrics",
    "presets",
    "settings",
]

"""Landmarks of faces without a click."""

import numpy as np
import pytest

import mesh_draping as md
from conftest import shared
from mesh_draping import face

pytest.importorskip("mediapipe")


def test_places_of_two_faces_belong_together(tmp_path):
    data = shared("ict_identity_gt")
    if data is None:
        pytest.skip("no data of ict_identity_gt here")
    source = md.Source(data / "source.obj")
    entries = face.mark(source, data / "target.obj", tmp_path / "pairs.json")
    assert len(entries) >= 12 and all(0.2 <= e["confidence"] <= 1 for e in entries)
    truth = md.Target(data / "gt_source_on_target.ply").vertices
    places = np.array([e["source"]["point"] for e in entries])
    near = np.linalg.norm(source.vertices[:, None] - places, axis=2).argmin(axis=0)
    missed = truth[near] - [e["target"]["point"] for e in entries]
    missed = np.linalg.norm(missed, axis=1) / np.ptp(truth, axis=0).max()
    print("missed by, in % of the longest side:", dict(zip([e["name"] for e in entries], (100 * missed).round(1))))
    assert np.median(missed) < 0.02 and missed.max() < 0.06
    checked = md.landmarks.read(tmp_path / "pairs.json", source, data / "target.obj")
    assert len(checked) == len(entries)


def test_a_shape_without_a_face_has_no_marks():
    vertices, faces = md.bench.pair("insect").source
    assert face.find((vertices, faces)) == {}
    with pytest.raises(md.Error, match="cloud"):
        face.find(vertices)

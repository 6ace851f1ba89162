"""What the tests of the Python module share."""

import os
import pathlib
import tempfile
import unittest

import loci

SOURCE = pathlib.Path(os.environ["LOCI_SOURCE_DIR"])
SAMPLES = SOURCE / "apps" / "samples"


class FolderTest(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)


class SampleMemoryTest(FolderTest):
    """A test with the memory of the sample's detections, closed."""

    def setUp(self):
        super().setUp()
        self.file = self.folder / "memory.loci"
        loci.ingest(SAMPLES / "detections.jsonl", self.file, map=SAMPLES / "kitchen.urdf", now="2026-05-02T00:00:00Z")


def tabletop(rows=240, columns=320):
    """A red and a blue box on a table, seen from above: camera, map_from_camera, depth, colour."""
    import numpy

    camera = loci.Camera(columns, rows, 290, 290, columns / 2, rows / 2)
    down = numpy.deg2rad(40)
    ahead = numpy.array([0, numpy.cos(down), -numpy.sin(down)])
    right = numpy.array([1.0, 0, 0])
    pose = numpy.eye(4)
    pose[:3, :3] = numpy.stack([right, numpy.cross(ahead, right), ahead], axis=1)
    pose[:3, 3] = [0, -1.0, 1.6]
    v, u = numpy.mgrid[0:rows, 0:columns]
    rays = numpy.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, numpy.ones(u.shape)], axis=-1)
    rays = rays @ pose[:3, :3].T
    depth = numpy.full((rows, columns), numpy.nan, numpy.float32)
    color = numpy.zeros((rows, columns, 3), numpy.uint8)
    for low, high, rgb in [
        ((-0.6, -0.3, 0.70), (0.6, 0.6, 0.75), (150, 110, 70)),
        ((-0.25, 0.1, 0.75), (-0.17, 0.18, 0.85), (200, 20, 20)),
        ((0.15, 0.1, 0.75), (0.25, 0.2, 0.95), (20, 20, 200)),
    ]:
        with numpy.errstate(divide="ignore"):
            sides = [(numpy.array(corner) - pose[:3, 3]) / rays for corner in (low, high)]
        near, far = numpy.minimum(*sides).max(axis=-1), numpy.maximum(*sides).min(axis=-1)
        hit = (0 < near) & (near < far) & ~(near >= depth)
        depth[hit], color[hit] = near[hit], rgb
    return camera, pose, depth, color


class TabletopTest(FolderTest):
    """A test with a recording of three frames of the table."""

    def setUp(self):
        super().setUp()
        self.recording = self.folder / "recording"
        self.camera, self.pose, self.depth, self.color = tabletop()
        with loci.RecordingWriter(self.recording, self.camera) as writer:
            for second in range(3):
                writer.add(f"2026-05-01T08:00:0{second}Z", self.depth, self.color, self.pose, {"door_1_joint": 0.1})

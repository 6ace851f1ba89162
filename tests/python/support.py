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

"""Maps and recordings."""

import datetime
import unittest

import loci
import numpy
from support import SAMPLES, FolderTest, TabletopTest


class Maps(FolderTest):
    def test_what_is_read_is_written(self):
        kitchen = loci.Map.read(SAMPLES / "kitchen.urdf")
        file = self.folder / "copy.urdf"
        kitchen.write(file)
        copy = loci.Map.read(file)
        self.assertEqual([link.name for link in copy.links], [link.name for link in kitchen.links])
        self.assertEqual(copy.semantics, kitchen.semantics)
        self.assertEqual(copy.semantics.links.counter_1["class"], "counter")
        for name, pose in kitchen.poses().items():
            numpy.testing.assert_allclose(copy.poses()[name], pose, atol=1e-9)

    def test_joints_move_links_and_can_be_changed(self):
        kitchen = loci.Map.read(SAMPLES / "kitchen.urdf")
        joint = next(joint for joint in kitchen.joints if joint.type == "prismatic")
        closed, opened = kitchen.poses()[joint.child], kitchen.poses({joint.name: 0.2})[joint.child]
        self.assertAlmostEqual(numpy.linalg.norm(opened[:3, 3] - closed[:3, 3]), 0.2)
        joint.upper = 0.123
        self.assertNotEqual(kitchen.joint(joint.name).upper, 0.123, "copies do not change the map")
        kitchen.put_joint(joint)
        kitchen.semantics.links.counter_1["aliases"] = ["the bar"]
        kitchen.write(self.folder / "changed.urdf")
        changed = loci.Map.read(self.folder / "changed.urdf")
        self.assertEqual(changed.joint(joint.name).upper, 0.123)
        self.assertEqual(changed.semantics.links.counter_1.aliases, ["the bar"])

    def test_a_map_from_nothing(self):
        own = loci.Map("cabin")
        floor, drawer = loci.Link("floor"), loci.Link("drawer_1_front")
        floor.add_box([3, 3, 0.02])
        pose = numpy.eye(4)
        pose[2, 3] = 0.4
        drawer.add_box([0.02, 0.5, 0.2], color=[0.8, 0.8, 0.8])
        own.put_link(floor)
        own.put_link(drawer)
        file = self.folder / "cabin.urdf"
        with self.assertRaises(loci.Error):
            own.write(file)  # two roots
        self.assertFalse(file.exists())
        own.put_joint(
            loci.Joint("drawer_1_joint", "prismatic", "floor", "drawer_1_front", parent_from_joint=pose, upper=0.4)
        )
        own.write(file)
        read = loci.Map.read(file)
        self.assertEqual(read.link("drawer_1_front").visuals[0].shape, "box")
        numpy.testing.assert_allclose(read.poses({"drawer_1_joint": 0.3})["drawer_1_front"][:3, 3], [0.3, 0, 0.4])
        self.assertIsNone(read.semantics)
        read.semantics = {"version": 1, "frame": "map", "links": {"ceiling": {"class": "ceiling", "confidence": 1}}}
        with self.assertRaisesRegex(loci.Error, "ceiling"):
            read.write(file)

    def test_files_of_others_are_not_replaced(self):
        file = self.folder / "kitchen.urdf"
        file.write_text("mine")
        kitchen = loci.Map.read(SAMPLES / "kitchen.urdf")
        with self.assertRaisesRegex(loci.Error, "force"):
            kitchen.write(file)
        self.assertEqual([each.name for each in self.folder.iterdir()], ["kitchen.urdf"])
        kitchen.write(file, force=True)
        kitchen.write(file)
        self.assertEqual(loci.Map.read(file).name, kitchen.name)

    def test_mistakes_are_named(self):
        with self.assertRaisesRegex(loci.Error, "did you mean 'prismatic'"):
            loci.Joint("j", "prismtic", "a", "b")
        with self.assertRaisesRegex(loci.Error, "no link 'zebra'"):
            loci.Map.read(SAMPLES / "kitchen.urdf").link("zebra")
        with self.assertRaises(loci.Error):
            loci.Map.read(self.folder / "missing.urdf")


class Recordings(TabletopTest):
    def test_frames_are_as_they_were_written(self):
        recording = loci.open_recording(self.recording)
        self.assertEqual((len(recording), recording.info().format), (3, "loci"))
        frames = list(recording)
        self.assertEqual(frames[1].time, datetime.datetime(2026, 5, 1, 8, 0, 1, tzinfo=datetime.timezone.utc))
        self.assertEqual(recording[-1].time_ns, frames[2].time_ns)
        numpy.testing.assert_allclose(frames[0].depth, self.depth, atol=1e-3)
        numpy.testing.assert_array_equal(frames[0].color, self.color)
        numpy.testing.assert_allclose(frames[0].map_from_camera, self.pose, atol=1e-6)
        self.assertEqual(frames[0].joints, {"door_1_joint": 0.1})
        self.assertEqual((frames[0].camera.fx, frames[0].camera.width), (290, 320))
        with self.assertRaises(IndexError):
            recording[3]

    def test_images_outlive_their_frame(self):
        depth = loci.open_recording(self.recording)[0].depth
        self.assertEqual(numpy.nansum(depth > 0), numpy.nansum(self.depth > 0))

    def test_nothing_is_left_of_what_failed(self):
        folder = self.folder / "failed"
        with self.assertRaisesRegex(ValueError, "enough"):
            with loci.RecordingWriter(folder, self.camera) as writer:
                writer.add("2026-05-01T08:00:00Z", self.depth)
                raise ValueError("enough")
        self.assertEqual([each.name for each in self.folder.iterdir()], ["recording"])

    def test_what_does_not_fit_is_refused(self):
        with loci.RecordingWriter(self.folder / "other", self.camera) as writer:
            time = "2026-05-01T08:00:00Z"
            for wrong in (
                lambda: writer.add(time, self.depth[:10]),
                lambda: writer.add(time, self.depth, self.color[:, :, 0]),
                lambda: writer.add(time, self.depth, self.color, numpy.eye(3)),
                lambda: writer.add("noon", self.depth),
            ):
                self.assertRaises(loci.Error, wrong)
            for wrong in (self.depth * 1000, numpy.full_like(self.depth, 100), self.depth == 1, self.depth.astype(str)):
                self.assertRaises(loci.Error, writer.add, time, wrong)
            writer.add(time, self.depth.astype(float))
            writer.add("2026-05-01T08:00:01Z", (numpy.nan_to_num(self.depth) * 1000).round().astype(numpy.uint16))
            writer.add("2026-05-01T08:00:02Z", numpy.zeros(self.depth.shape, numpy.uint16))
        metres, millimetres, nothing = loci.open_recording(self.folder / "other")
        numpy.testing.assert_allclose(millimetres.depth, metres.depth, atol=0.001)
        self.assertTrue(numpy.isnan(nothing.depth).all())
        with self.assertRaisesRegex(loci.Error, "no frame"), loci.RecordingWriter(self.folder / "none", self.camera):
            pass
        self.assertFalse((self.folder / "none").exists())
        self.assertEqual(len(loci.open_recording(self.folder / "other")), 3)
        with self.assertRaisesRegex(loci.Error, "upp.*did you mean 'up'"):
            loci.open_recording(self.recording, upp="z")


if __name__ == "__main__":
    unittest.main()

"""Pipelines with annotators of Python, and what memories keep of their scenes."""

import os
import signal
import unittest

import loci
import numpy
from support import SOURCE, TabletopTest


class Redness(loci.Annotator):
    """Says which objects are red."""

    inputs = ["Cluster", "StandaloneImageROI"]
    outputs = ["ClassificationAnnotation"]
    options = {"red": 0.5}

    def process(self, scene):
        for cluster in scene.clusters:
            share = cluster.image[..., 0].mean() / cluster.image.sum(axis=-1).mean()
            if share > self.red:
                cluster.annotate("ClassificationAnnotation", kind="object", label="fire box", confidence=float(share))


class Pipelines(TabletopTest):
    def test_annotations_of_python_are_remembered(self):
        memory = self.folder / "memory.loci"
        result = loci.run(self.recording, annotators=[Redness], memory=memory)
        self.assertEqual((result.frames, result.left_out), (3, 0))
        self.assertIn("Redness", [name for name, seconds in result.seconds])
        with loci.open(memory) as opened:
            self.assertEqual([each.color for each in opened.where("fire box").objects], ["red"])
            scene = next(opened.iter_scenes())
            self.assertEqual((scene.image().shape, scene.image().dtype), ((240, 320, 3), numpy.uint8))
            self.assertLess(numpy.abs(scene.image().astype(int) - self.color).mean(), 3)  # JPEG
            self.assertEqual(scene.depth().dtype, numpy.float32)
            self.assertAlmostEqual(float(numpy.nanmin(scene.depth())), float(numpy.nanmin(self.depth)), delta=0.02)
            self.assertEqual(scene.camera.fx, 290)
            red = next(each for each in scene.observations() if each.color == "red")
            self.assertEqual(red.mask().shape, (240, 320))
            points, colors = red.cloud()
            self.assertEqual(len(points), numpy.count_nonzero(red.mask()))
            numpy.testing.assert_allclose(points.mean(axis=0), [-0.21, 0.12, 0.82], atol=0.03)
            self.assertGreater(colors[:, 0].mean(), 150)
            self.assertEqual(scene.labels()[red.mask() > 0].max(), int(red.object[len("object_") :]))
            self.assertGreater(red.crop()[..., 0].mean(), 100)

    def test_what_an_annotator_sees(self):
        seen = []

        class Look(loci.Annotator):
            inputs = ["Cluster", "view:cloud", "view:normals"]
            outputs = ["view:mine"]

            def process(self, scene):
                cluster = scene.clusters[0]
                scene.set_view("mine", scene.depth * 2)
                numpy.testing.assert_allclose(scene.view("mine"), scene.depth * 2)
                numpy.testing.assert_allclose(
                    cluster.points.mean(axis=0), numpy.nanmean(scene.cloud[cluster.mask > 0], axis=0), atol=1e-3
                )
                seen.append((scene.frame, scene.color.shape, scene.depth.flags.writeable, scene.normals.shape))
                numpy.testing.assert_allclose(numpy.linalg.inv(scene.map_from_camera) @ scene.map_from_camera, numpy.eye(4), atol=1e-9)
                scene.log("looked")

        loci.run(self.recording, annotators=[Look])
        self.assertEqual(seen, [(i, (240, 320, 3), False, (240, 320, 3)) for i in range(3)])

    def test_pipelines_name_annotators_and_set_options(self):
        values = []

        class Options(loci.Annotator):
            inputs = ["Cluster"]
            options = {"flag": False, "count": 3, "share": 0.5, "word": "a"}

            def start(self):
                values.append((self.flag, self.count, self.share, self.word))

            def process(self, scene):
                pass

        flow = ["NormalEstimator", "KnownStructureFilter", "PlaneClusterExtractor"]
        loci.run(self.recording, pipeline={"flow": [*flow, {"Options": {"count": 7, "word": "b"}}]}, annotators=[Options])
        self.assertEqual(values, [(False, 7, 0.5, "b")])
        with self.assertRaisesRegex(loci.Error, "cuont"):
            loci.run(self.recording, pipeline={"flow": [*flow, {"Options": {"cuont": 7}}]}, annotators=[Options])
        with self.assertRaisesRegex(loci.Error, "NormalEstimator"):
            loci.run(self.recording, annotators=[type("NormalEstimator", (Options,), {})])

    def test_one_object_is_made_per_run(self):
        made = []

        class Counted(loci.Annotator):
            def __init__(self):
                made.append(self)

            def process(self, scene):
                assert self is made[0]

        loci.run(self.recording, annotators=[Counted])
        self.assertEqual(len(made), 1)

    def test_types_of_a_user(self):
        class Brightness(loci.Annotator):
            inputs = ["Cluster", "StandaloneImageROI"]
            outputs = ["BrightnessAnnotation"]

            def process(self, scene):
                for cluster in scene.clusters:
                    cluster.annotate("BrightnessAnnotation", mean=float(cluster.image.mean() / 255), word="bright")

        found = []
        types = [SOURCE / "docs/examples/plugin/brightness.xml"]
        loci.run(
            self.recording,
            annotators=[Brightness],
            types=types,
            done=lambda scene: found.extend(each for cluster in scene.clusters for each in cluster.annotations),
        )
        words = [each.word for each in found if each.type == "BrightnessAnnotation"]
        self.assertEqual(words, ["bright"] * 6)

    def test_failures_say_where(self):
        class Fails(loci.Annotator):
            inputs = ["Cluster"]

            def process(self, scene):
                return 1 / 0

        with self.assertRaisesRegex(loci.Error, r"Fails failed at frame 0: ZeroDivisionError: .*perception_test.py\("):
            loci.run(self.recording, annotators=[Fails])

        class Unknown(Fails):
            def process(self, scene):
                scene.clusters[0].annotate("ClasificationAnnotation")

        with self.assertRaisesRegex(loci.Error, "did you mean 'ClassificationAnnotation'"):
            loci.run(self.recording, annotators=[Unknown])

        class Wrong(Fails):
            def process(self, scene):
                scene.clusters[0].annotate("ClassificationAnnotation", colour="red")

        with self.assertRaisesRegex(loci.Error, "has no feature 'colour'"):
            loci.run(self.recording, annotators=[Wrong])

        class Raises(Fails):
            def __init__(self):
                raise ValueError("no licence")

        with self.assertRaisesRegex(loci.Error, "no licence"):
            loci.run(self.recording, annotators=[Raises])

        class Undeclared(Fails):
            outputs = ["Nonsense"]

        class Empty(loci.Annotator):
            pass

        for wrong in (Undeclared, Empty, Fails(), str, "Fails"):
            self.assertRaises(loci.Error, loci.run, self.recording, annotators=[wrong])
        with self.assertRaisesRegex(loci.Error, "every"):
            loci.run(self.recording, every=-1)
        with self.assertRaisesRegex(loci.Error, "progress returned False"):
            loci.run(self.recording, progress=lambda fraction, text: False)

    def test_values_of_numpy_are_annotated(self):
        class Measures(loci.Annotator):
            inputs = ["Cluster", "StandaloneImageROI"]
            outputs = ["ClassificationAnnotation"]
            options = {"share": numpy.float32(0.1), "count": numpy.int64(3)}

            def process(self, scene):
                for cluster in scene.clusters:
                    height = cluster.points[:, 2].mean()
                    cluster.annotate("ClassificationAnnotation", kind="object", label="far", confidence=height * self.share)

        found = []
        loci.run(
            self.recording,
            annotators=[Measures],
            done=lambda scene: found.extend(each for cluster in scene.clusters for each in cluster.annotations),
        )
        own = [each for each in found if each.get("label") == "far"]
        self.assertTrue(own)
        self.assertTrue(all(0.05 < each.confidence < 0.5 for each in own))

    def test_arrays_are_annotated_and_read(self):
        arrays = {
            "feature": numpy.linspace(-1, 1, 200, dtype=numpy.float32),
            "places": numpy.arange(6, dtype=numpy.int16).astype(numpy.float64),
        }

        class Describes(loci.Annotator):
            inputs = ["Cluster"]
            outputs = ["ImageFeatureAnnotation", "ColorAnnotation"]

            def process(self, scene):
                for cluster in scene.clusters:
                    cluster.annotate("ImageFeatureAnnotation", name="mine", feature=arrays["feature"])
                    cluster.annotate("ImageFeatureAnnotation", name="other", feature=arrays["places"])
                    cluster.annotate("ColorAnnotation", names=numpy.array(["red", "blue"]))

        found = []
        memory = self.folder / "arrays.loci"
        loci.run(
            self.recording,
            annotators=[Describes],
            memory=memory,
            done=lambda scene: found.extend(each for cluster in scene.clusters for each in cluster.annotations),
        )
        for name, values in (("mine", arrays["feature"]), ("other", arrays["places"])):
            read = [each.feature for each in found if each.get("name") == name]
            self.assertTrue(read)
            for each in read:
                numpy.testing.assert_array_equal(numpy.array(each, dtype=numpy.float32), values)
        self.assertIn(["red", "blue"], [each.names for each in found if each.type == "ColorAnnotation"])
        self.assertTrue(memory.exists())

        class Wrong(Describes):
            def process(self, scene):
                scene.clusters[0].annotate("ImageFeatureAnnotation", name="mine", feature=numpy.array([1, numpy.nan]))

        with self.assertRaisesRegex(loci.Error, "ImageFeatureAnnotation.feature: is not a finite number"):
            loci.run(self.recording, annotators=[Wrong])

    def test_what_is_no_value_is_refused_at_the_line_of_the_user(self):
        def annotator(**features):
            class Wrong(loci.Annotator):
                inputs = ["Cluster"]
                outputs = ["ClassificationAnnotation"]

                def process(self, scene):
                    scene.clusters[0].annotate("ClassificationAnnotation", **features)

            return Wrong

        for features, reason in (
            ({"confidence": float("nan")}, "ClassificationAnnotation.confidence: is not a finite number"),
            ({"confidence": {1, 2}}, "ClassificationAnnotation.confidence: a set cannot be given here"),
        ):
            with self.assertRaisesRegex(loci.Error, rf"{reason}.* at .*perception_test.py\(\d+\): process$"):
                loci.run(self.recording, annotators=[annotator(**features)])

    def test_interrupts_stop_the_run_and_finish(self):
        finished = []

        class Stops(loci.Annotator):
            inputs = ["Cluster"]

            def process(self, scene):
                raise KeyboardInterrupt

            def finish(self):
                finished.append(type(self).__name__)

        class Signalled(Stops):
            def process(self, scene):
                os.kill(os.getpid(), signal.SIGINT)

        class Fails(Stops):
            def process(self, scene):
                assert scene is None

        flow = ["NormalEstimator", "KnownStructureFilter", "PlaneClusterExtractor", {"Stops": {}, "on_error": "skip"}]
        self.assertRaises(KeyboardInterrupt, loci.run, self.recording, pipeline={"flow": flow}, annotators=[Stops])
        self.assertRaises(KeyboardInterrupt, loci.run, self.recording, annotators=[Signalled], threads=1)
        with self.assertRaisesRegex(loci.Error, r"Fails failed at frame 0: AssertionError at "):
            loci.run(self.recording, annotators=[Fails])
        self.assertEqual(finished, ["Stops", "Signalled", "Fails"])

    def test_declarations_are_checked(self):
        def declares(**declared):
            return type("Mine", (loci.Annotator,), {"process": lambda self, scene: None, **declared})

        for declared, reason in (
            ({"inputs": "Cluster"}, r"Mine.inputs is 'Cluster'; give a list of texts"),
            ({"outputs": 3}, r"Mine.outputs is 3; give a list of texts"),
            ({"options": {"x": [1]}}, r"Mine.options.x is \[1\]; give a bool, an int"),
            ({"options": {"x": 2**40}}, r"Mine.options.x is 1099511627776; give"),
            ({"options": ["x"]}, r"Mine.options is \['x'\]; give a dictionary"),
        ):
            with self.assertRaisesRegex(loci.Error, f"^{reason}"):
                loci.run(self.recording, annotators=[declares(**declared)])

    def test_pipelines_are_files_too(self):
        file = self.folder / "pipeline.yaml"
        file.write_text("flow: [NormalEstimator, KnownStructureFilter, PlaneClusterExtractor]")
        for pipeline in (file, str(file)):
            self.assertEqual(loci.run(self.recording, pipeline=pipeline).frames, 3)
        file.write_text("flow: [NormalEstimatr]")
        with self.assertRaisesRegex(loci.Error, "pipeline.yaml:1.*did you mean 'NormalEstimator'"):
            loci.run(self.recording, pipeline=file)

    def test_scenes_end(self):
        kept = []
        loci.run(self.recording, done=kept.append)
        self.assertEqual(len(kept), 3)
        with self.assertRaisesRegex(loci.Error, "this scene is over"):
            kept[0].depth

        def fail(scene):
            raise ValueError("enough")

        with self.assertRaisesRegex(ValueError, "enough"):
            loci.run(self.recording, done=fail)

    def test_frames_are_taken_once(self):
        memory = self.folder / "memory.loci"
        loci.run(self.recording, memory=memory)
        with self.assertRaises(loci.Error):
            loci.run(self.recording, memory=memory)
        self.assertEqual(loci.run(self.recording, memory=memory, resume=True).skipped, 3)

    def test_annotators_are_described(self):
        names = [each.name for each in loci.describe_annotators()]
        self.assertIn("PlaneClusterExtractor", names)
        self.assertIn("PlaneClusterExtractor", loci.default_pipeline())


if __name__ == "__main__":
    unittest.main()

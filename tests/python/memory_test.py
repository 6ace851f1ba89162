"""Memories: questions, scenes, tables, ingest."""

import datetime
import json
import os
import subprocess
import sys
import threading
import time
import unittest

import loci
import numpy
from support import SAMPLES, FolderTest, SampleMemoryTest

UTC = datetime.timezone.utc


def command(*arguments):
    """What loci-memory prints."""
    program = os.path.join(os.environ["LOCI_BIN_DIR"], "loci-memory")
    return subprocess.run([program, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


class Questions(SampleMemoryTest):
    def test_every_question_is_a_method_with_its_parameters(self):
        for question in json.loads(command("questions", "--json"))["questions"]:
            name = question["name"].replace("-", "_")
            method = getattr(loci.Memory, name, None) or getattr(loci.Memory, name + "_")
            self.assertTrue(method.__doc__.startswith(question["description"]))
            for parameter in question["parameters"]:
                self.assertIn(parameter["help"], method.__doc__)

    def test_answers_are_those_of_the_command(self):
        with loci.open(self.file) as memory:
            answer = memory.where("mug", at="08:00")
        details = command("where", "mug", "--at", "08:00", "--details", "-m", self.file)
        self.assertEqual(details.split("\n", 1)[0], "The mug was probably on table_1.")
        self.assertEqual(answer.reply.text, "The mug was probably on table_1.")
        self.assertEqual(str(answer), details)
        data = json.loads(command("where", "mug", "--at", "08:00", "-m", self.file, "--json"))
        self.assertEqual(dict(answer), data)
        self.assertEqual(answer.objects[0].place, data["objects"][0]["place"])
        with self.assertRaisesRegex(AttributeError, "there is no 'zebra'; there are: .*objects"):
            answer.zebra

    def test_arguments_may_be_values(self):
        with loci.open(self.file) as memory:
            at = datetime.datetime(2026, 5, 1, 8, tzinfo=UTC)
            self.assertEqual(memory.where("mug", at=at), memory.where("mug", at="2026-05-01T08:00:00Z"))
            self.assertEqual(memory.near((2.5, 0.6), radius=0.5, at=at), memory.near("2.5,0.6", radius="50 cm", at=at))
            self.assertEqual(memory.scene_type(scene=3), memory.scene_type(scene="3"))
            with self.assertRaisesRegex(loci.Error, "needs a zone"):
                memory.where("mug", at=datetime.datetime(2026, 5, 1, 8))

    def test_wrong_arguments_are_refused(self):
        with loci.open(self.file) as memory:
            with self.assertRaisesRegex(loci.Error, "nothing is known as 'zebra'"):
                memory.where("zebra")
            for wrong in (lambda: memory.where(), lambda: memory.where("mug", colour="red")):
                self.assertRaisesRegex(TypeError, r"where\(\): .*; it takes \(self, object", wrong)
            for wrong in (
                lambda: memory.where(["a"]),
                lambda: memory.where(b"red"),
                lambda: memory.where(""),
                lambda: memory.where([]),
                lambda: memory.ask(3),
                lambda: memory.ask("Where is the mug?", before="Where is the bowl?"),
                lambda: memory.on("table_1", count="abc"),
                lambda: memory.on("table_1", count=-1),
            ):
                self.assertRaises(loci.Error, wrong)
            self.assertEqual(memory.on("table_1", count=99, at="08:00").verdict, "no")

    def test_what_the_command_takes_without_a_name_goes_by_position(self):
        with loci.open(self.file) as memory:
            self.assertEqual(memory.was("mug", "table_1"), memory.was("mug", place="table_1"))
            self.assertEqual(memory.task("set", "table_1"), memory.task("set", place="table_1"))
            data = json.loads(command("task", "set", "table_1", "-m", self.file, "--json"))
            self.assertEqual(dict(memory.task("set", "table_1")), data)

    def test_errors_name_keywords_not_options_of_the_command(self):
        with self.assertRaisesRegex(loci.Error, "or give force=True$"):
            loci.Map.read(SAMPLES / "kitchen.urdf").write(SAMPLES / "kitchen.urdf")

    def test_sentences(self):
        with loci.open(self.file) as memory:
            self.assertIn("counter_1", str(memory.ask("Where is the mug?")))
            self.assertEqual(
                memory.ask("When was it last seen?", before=["Where is the bowl?"]).answer,
                memory.ask("When was the bowl last seen?").answer,
            )
            with self.assertRaises(loci.NotUnderstood) as caught:
                memory.ask("Fribble the gromp?")
            self.assertTrue(caught.exception.nearest)
            self.assertIsInstance(caught.exception, loci.Error)


class Contents(SampleMemoryTest):
    def test_scenes_with_their_observations(self):
        with loci.open(self.file) as memory:
            scenes = list(memory)
            self.assertEqual(len(scenes), 12)
            self.assertEqual(scenes[0].time, datetime.datetime(2026, 5, 1, 7, 10, tzinfo=UTC))
            self.assertEqual([scene.id for scene in scenes], sorted(scene.id for scene in scenes))
            morning = list(memory.iter_scenes(to=datetime.datetime(2026, 5, 1, 8, tzinfo=UTC)))
            self.assertEqual([scene.id for scene in morning], [1, 2, 3, 4, 5])
            mug = memory.scene(1).observations()[0]
            self.assertEqual((mug.object, mug.place, mug.color), ("object_1", "counter_1", "red"))
            self.assertEqual(mug.position.shape, (3,))
            self.assertIn(("loci.annotation.ClassificationAnnotation", "mug", 0.86), mug.annotations())
            self.assertIsNone(scenes[0].image())
            with self.assertRaisesRegex(loci.Error, "99"):
                memory.scene(99)

    def test_tables_are_columns(self):
        with loci.open(self.file) as memory:
            objects = memory.table("objects")
            self.assertEqual({len(column) for column in objects.values()}, {4})
            self.assertIsInstance(objects["probability"][0], float)
            self.assertEqual(len(memory.table("scenes")["scene"]), 12)
            facts = memory.table("facts")
            self.assertEqual([facts["key"], facts["value"]], [[], []])
            for unknown in ("zebra", "v_objects"):
                with self.assertRaisesRegex(loci.Error, f"no table '{unknown}'; there are: objects"):
                    memory.table(unknown)

    def test_arguments_of_wrong_types_are_errors_of_one_line(self):
        with loci.open(self.file) as memory:
            for wrong in (
                lambda: memory.scene("1"),
                lambda: memory.scene(),
                lambda: memory.table(3),
                lambda: loci.run(3),
                lambda: loci.ingest("a.jsonl", 3),
                lambda: loci.Camera("a"),
            ):
                with self.assertRaisesRegex(loci.Error, r"an argument is missing or of a wrong type; it takes \(.*\)[^\n]*$"):
                    wrong()
            with self.assertRaisesRegex(loci.Error, r"^Memory.scene: .*; it takes \(id: int\)$"):
                memory.scene("1")

    def test_what_was_closed_answers_no_more(self):
        memory = loci.open(self.file)
        scene = memory.scene(1)
        memory.close()
        memory.close()
        for use in (memory.objects, scene.observations, lambda: memory.table("objects")):
            with self.assertRaisesRegex(loci.Error, "is closed"):
                use()

    def test_reading_changes_nothing(self):
        before = self.file.read_bytes()
        with loci.open(self.file) as memory:
            memory.objects()
            with self.assertRaises(loci.Error):
                memory.teach("mug", "cup")
        self.assertEqual(self.file.read_bytes(), before)

    def test_other_threads_go_on(self):
        """With an interval that never ends, another thread runs only when this one gives up the lock."""
        interval = sys.getswitchinterval()
        self.addCleanup(sys.setswitchinterval, interval)
        stop, turns = threading.Event(), [0]

        def count():
            while not stop.is_set():
                turns[0] += 1
                time.sleep(0.0001)

        with loci.open(self.file) as memory:
            thread = threading.Thread(target=count)
            sys.setswitchinterval(1000)
            thread.start()
            went_on = False
            for _ in range(2000):
                before = turns[0]
                memory.objects()
                went_on = turns[0] > before
                if went_on:
                    break
            stop.set()
            thread.join()
        self.assertTrue(went_on)

    def test_threads_share_a_memory(self):
        with loci.open(self.file) as memory:
            expected, answers = str(memory.objects()), []
            threads = [threading.Thread(target=lambda: answers.append(str(memory.objects()))) for _ in range(8)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
        self.assertEqual(answers, [expected] * 8)


class Writing(FolderTest):
    def test_ingests_scenes_from_python(self):
        file = self.folder / "own.loci"
        scene = {"time": "2026-05-01T08:30:00Z", "detections": [{"position": [1, 2, 0.9], "class": {"mug": 0.9}}]}
        fractions = []
        report = loci.ingest([scene], file, progress=lambda fraction, text: fractions.append(fraction))
        self.assertEqual((report.scenes, report.detections), (1, 1))
        self.assertTrue(fractions)
        with loci.open(file) as memory:
            self.assertEqual(memory.objects().objects[0].label, "mug")

    def test_bad_scenes_of_python_are_named(self):
        good = {"time": "2026-05-01T08:30:00Z", "detections": [{"position": numpy.array([1, 2, 0.9])}]}
        nan = {"time": "2026-05-01T08:31:00Z", "detections": [{"position": numpy.array([1, numpy.nan, 2])}]}
        with self.assertWarnsRegex(UserWarning, r"^detections:2: detections\[0\].position: .* is NaN") as caught:
            loci.ingest([good, nan], self.folder / "m.loci", noise_m=numpy.float32(0.01))
        self.assertEqual(caught.filename, __file__)
        for wrong, reason in (
            ([nan], r"^detections:1: detections\[0\].position: must be a finite number, is NaN"),
            ([good, {"time": {1}}], r"^detections:2: a set cannot be given here"),
            (good, "detections are a file or a list of scenes"),
            (None, "detections are a file or a list of scenes"),
            ([], "^detections: has no scenes"),
        ):
            with self.assertRaisesRegex(loci.Error, reason):
                loci.ingest(wrong, self.folder / "n.loci")
        with self.assertRaisesRegex(loci.Error, "a memory in a database is read"):
            loci.ingest([good], "postgresql://localhost/kitchen?robot=a")

    def test_what_the_last_look_missed_is_not_counted_as_there(self):
        """As the command line has it."""
        file = self.folder / "own.loci"
        mug = {"position": [1.0, 2, 0.8], "class": "mug", "place": "table_1"}
        box = {"position": [1.5, 2, 0.8], "class": "box", "place": "table_1"}
        looked = [{"place": "table_1", "fraction": 0.5}]
        loci.ingest(
            [
                {"time": f"2026-05-01T08:{minute}:00Z", "observed": looked, "detections": seen}
                for minute, seen in (("00", [mug, box]), ("10", [mug, box]), ("20", [box]))
            ],
            file,
        )
        self.assertIn("perhaps also: the mug", command("on", "table_1", "-m", file))
        with loci.open(file) as memory:
            self.assertRegex(str(memory.on("table_1")), "^The box is on table_1.\n1 object is, perhaps 1 more, on table_1")
            self.assertTrue(str(memory.was("mug", "on table_1")).startswith("Yes: the mug was on table_1, "))

    def test_options_of_ingest_are_checked(self):
        with self.assertRaisesRegex(loci.Error, "strictt.*did you mean 'strict'"):
            loci.ingest(SAMPLES / "detections.jsonl", self.folder / "m.loci", strictt=True)
        with self.assertRaisesRegex(loci.Error, "no such file|cannot"):
            loci.ingest("nothing.jsonl", self.folder / "m.loci")
        with self.assertRaisesRegex(loci.Error, "zebra.*known are .*strict"):
            loci.ingest(SAMPLES / "detections.jsonl", self.folder / "m.loci", zebra=True)

    def test_progress_stops_with_its_exception(self):
        def fail(fraction, text):
            raise ValueError("enough")

        with self.assertRaisesRegex(ValueError, "enough"):
            loci.ingest(SAMPLES / "detections.jsonl", self.folder / "m.loci", progress=fail)
        with self.assertRaisesRegex(loci.Error, "progress returned False"):
            loci.ingest(SAMPLES / "detections.jsonl", self.folder / "n.loci", progress=lambda fraction, text: False)

    def test_no_file_is_made_by_reading(self):
        with self.assertRaises(loci.Error):
            loci.open(self.folder / "missing.loci")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_teaching_names_the_example(self):
        file = self.folder / "own.loci"
        loci.ingest(SAMPLES / "detections.jsonl", file)
        with loci.open(file, write=True) as memory:
            memory.teach("object_1", "beaker")
            self.assertEqual(memory.where("object_1").objects[0].label, "beaker")


class Watch(FolderTest):
    def test_events_are_reported_while_a_memory_is_written(self):
        """A program waits; scenes come one after the other."""
        file = self.folder / "watched.loci"
        mug = {"position": [1.0, 2.7, 0.9], "size": [0.1, 0.1, 0.1], "class": {"mug": 0.9}, "place": "counter_1"}

        def ingest(minute, *detections):
            seen = [{"place": "counter_1", "fraction": 1}, {"place": "table_1", "fraction": 1}]
            scene = {"time": f"2026-05-01T08:{minute:02}:00Z", "observed": seen, "detections": list(detections)}
            loci.ingest([scene], file)

        ingest(0, mug)
        ingest(1, mug)
        program = os.path.join(os.environ["LOCI_BIN_DIR"], "loci-memory")
        command = [program, "watch", "milk appears", "anything comes to table_1", "-m", str(file), "--count", "1"]
        command += ["--for", "60", "--run", "echo ran: $LOCI_QUESTION; exit 3"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as watching:
            time.sleep(1.5)
            moved = {**mug, "position": [2.0, 0.6, 0.8], "place": "table_1"}
            for minute in range(2, 6):
                ingest(minute, moved)
            out, err = watching.communicate(timeout=90)
        self.assertIn("table_1", out)
        self.assertIn("(anything comes to table_1)\n", out)  # which of the questions it answers
        self.assertIn("ran: anything comes to table_1", out)
        self.assertIn("ended with status 3", err)
        self.assertIn("milk", err)  # not known yet
        self.assertEqual(watching.returncode, 0)


    def test_no_event_is_no_count(self):
        program = os.path.join(os.environ["LOCI_BIN_DIR"], "loci-memory")
        command = [program, "watch", "anything appears", "-m", "none.loci", "--count", "0", "--for", "1"]
        ended = subprocess.run(command, capture_output=True, text=True)
        self.assertEqual(ended.returncode, 2)
        self.assertIn("0 is not allowed (at least 1)", ended.stderr)

    def test_a_memory_that_is_made_later_is_waited_for(self):
        file = self.folder / "later.loci"
        program = os.path.join(os.environ["LOCI_BIN_DIR"], "loci-memory")
        command = [program, "watch", "anything appears", "unicorn moves", "drawer_99 opens", "-m", str(file)]
        command += ["--count", "1", "--for", "60"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as watching:
            self.assertIn("waiting for it", watching.stderr.readline())
            loci.ingest(SAMPLES / "detections.jsonl", file)
            out, err = watching.communicate(timeout=90)
        self.assertIn("appeared", out)
        self.assertIn("unicorn", err)
        self.assertIn("drawer_99", err)
        self.assertEqual(watching.returncode, 0)


class Edits(SampleMemoryTest):
    def test_edits_can_be_undone(self):
        with loci.open(self.file, write=True) as memory:
            done = memory.edit.say("table_1", "alias", "bench 7")
            self.assertIn("bench 7", done.edit)
            self.assertIn("object_1", str(memory.on("bench 7", at="08:00")))
            memory.edit.label(scene=1, observation=0, class_="mug")
            self.assertTrue(memory.edit.undo().reply.text.startswith("Undone: observation 0 of scene 1"))
            memory.edit.undo()
            self.assertEqual([len(memory.edit.list().done), len(memory.edit.list().undone)], [0, 2])
            with self.assertRaisesRegex(loci.Error, "bench 7"):
                memory.on("bench 7")

    def test_identities(self):
        with loci.open(self.file, write=True) as memory:
            self.assertRaises(loci.Error, memory.edit.merge, "object_1", "object_3")
            memory.edit.split("object_1", "2026-05-01T12:00:00Z")
            self.assertEqual(len(memory.objects().objects), 5)

    def test_reading_is_not_writing(self):
        with loci.open(self.file) as memory:
            with self.assertRaisesRegex(loci.Error, "open for reading"):
                memory.edit.undo()


if __name__ == "__main__":
    unittest.main()

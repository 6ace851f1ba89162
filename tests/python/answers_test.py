"""The declared fields of answers: those of the stubs, and those of real answers of a sample memory."""

import ast
import importlib.util
import os
import pathlib
import subprocess
import sys
import typing
import unittest

import loci
from loci.answers import python_name
from support import SOURCE, FolderTest, SampleMemoryTest

PACKAGE = pathlib.Path(loci.__file__).parent

# What each question is asked about the sample memory; those that are not here need no arguments.
ARGUMENTS = {
    "about": [{"object": "mug"}],
    "co_occurrence": [{"object": "mug"}, {"object": "mug", "with_": "bowl"}],
    "compare": [{"object": "mug", "with_": "bowl"}, {"object": "mug", "with_": "bowl", "by": "left-before"}],
    "contents_history": [{"place": "counter_1"}],
    "empty": [{"place": "counter_1"}, {"place": "table_1", "from_": "07:00"}],
    "history": [{"object": "mug"}],
    "in_": [{"place": "counter_1"}],
    "life_cycle": [{"object": "mug"}],
    "like": [{"image": SOURCE / "tests/data/images/ean13.png"}],
    "missing": [{}, {"place": "table_1", "occasion": "breakfast"}],
    "near": [{"around": "2.5,0.6", "radius": "1 m"}, {"around": "table_1"}],
    "on": [{"place": "table_1"}, {"place": "counter_1", "object": "mug"}],
    "search_next": [{"object": "mug", "start": (1, 1)}],
    "task": [{"task": "bring", "object": "mug"}, {"task": "stow", "object": "mug"}],
    "usual": [{"object": "mug"}, {"object": "mug", "during": "breakfast"}],
    "was": [{"object": "mug", "place": "table_1", "from_": "07:00", "to": "12:00"}, {"object": "mug", "at": "08:00"}],
    "where": [{"object": "mug"}, {"object": "object_1", "at": "08:00"}],
}


def mistakes(value, kind, path):
    """Where a value is not what its type says."""
    if isinstance(kind, type) and issubclass(kind, loci.Fields):
        declared = kind.__annotations__
        found = [f"{path}.{name} is not declared" for name in value if python_name(name) not in declared]
        if type(value) is not kind:
            found.append(f"{path} is a {type(value).__name__}, not a {kind.__name__}")
        for name, each in declared.items():
            field = getattr(value, name)
            if field is not None or type(None) not in typing.get_args(each):
                found += mistakes(field, each, f"{path}.{name}")
        return found
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Union:  # Optional, and there is a value
        return mistakes(value, arguments[0], path)
    if origin is typing.Literal:
        return [] if value in arguments else [f"{path} is {value!r}"]
    if origin is list and isinstance(value, list):
        return [text for i, each in enumerate(value) for text in mistakes(each, arguments[0], f"{path}[{i}]")]
    if origin is dict and isinstance(value, dict):
        return [text for key, each in value.items() for text in mistakes(each, arguments[1], f"{path}[{key}]")]
    return [] if kind is typing.Any or type(value) is kind else [f"{path} is {value!r}, not {kind}"]


class Answers(SampleMemoryTest):
    def test_every_question_answers_with_its_declared_fields(self):
        left_out = set()
        with loci.open(self.file) as memory:
            for question in loci.answers.declared.questions:
                name = python_name(question.name)
                kind = getattr(loci.answers, question.answer)
                for arguments in ARGUMENTS.get(name, [{}]):
                    answer = getattr(memory, name)(**arguments)
                    self.assertIsInstance(answer, loci.Answer)
                    self.assertEqual(mistakes(answer, kind, name), [], arguments)
                    left_out |= {each for each in kind.__annotations__ if getattr(answer, each) is None}
            for sentence in ("Where is the mug?", "Where was the mug at 8?", "How many cups are on the counter?"):
                self.assertEqual(mistakes(memory.ask(sentence), loci.answers.SentenceAnswer, sentence), [])
        self.assertIn("from_", left_out, "some fields are optional")

    def test_mistakes_would_be_found(self):
        with loci.open(self.file) as memory:
            answer = memory.where("mug")
        answer.objects[0]["colour"] = "red"
        del answer.objects[0]["probability"]
        answer.objects[0]["status"] = "lost"
        self.assertEqual(len(mistakes(answer, loci.answers.WhereAnswer, "where")), 3)

    def test_what_is_left_out_is_none_and_what_is_not_declared_is_a_mistake(self):
        with loci.open(self.file) as memory:
            changes = memory.changes()
        self.assertIsNone(changes.from_)
        self.assertNotIn("from", changes)
        with self.assertRaisesRegex(AttributeError, "there is no 'zebra'"):
            changes.zebra


class Stubs(FolderTest):
    def test_stubs_have_every_class_with_its_fields(self):
        stub = ast.parse((PACKAGE / "answers.pyi").read_text())
        fields = {}
        for node in stub.body:
            if isinstance(node, ast.ClassDef):
                declared = [each for each in node.body if isinstance(each, ast.AnnAssign)]
                fields[node.name] = {each.target.id: ast.unparse(each.annotation) for each in declared}
        self.assertEqual(sorted(fields), loci.answers.__all__)
        for name, declared in fields.items():
            self.assertEqual(list(declared), list(getattr(loci.answers, name).__annotations__), name)
        self.assertEqual(fields["WhereAnswer"], {"asked": "str", "objects": "List[LocatedObject]", "reply": "Reply"})
        self.assertEqual(fields["LocatedObject"]["place"], "Optional[str]")

    def lines_with_mistakes(self, *files):
        """What mypy objects to in a file or several."""
        if importlib.util.find_spec("mypy") is None:
            self.skipTest("needs mypy")
        environment = {**os.environ, "MYPYPATH": str(PACKAGE.parent)}
        checked = subprocess.run(
            [sys.executable, "-m", "mypy", "--cache-dir", str(self.folder / "cache"), *map(str, files)],
            capture_output=True,
            text=True,
            env=environment,
        )
        self.assertIn(checked.returncode, (0, 1), checked.stderr)
        return sorted({int(line.split(":")[1]) for line in checked.stdout.splitlines() if ": error:" in line})

    def test_mypy_accepts_the_stubs(self):
        self.assertEqual(self.lines_with_mistakes(PACKAGE / "__init__.pyi", PACKAGE / "answers.pyi"), [])

    def test_mypy_knows_the_fields(self):
        program = self.folder / "program.py"
        program.write_text(
            "import loci\n"
            "with loci.open('m.loci') as memory:\n"
            "    answer = memory.where('mug')\n"
            "    place: str = answer.objects[0].place or 'nowhere'\n"
            "    chance: float = answer.objects[0].probability\n"
            "    since: str | None = memory.changes().from_\n"
            "    answer.objects[0].colour\n"
            "    number: int = answer.objects[0].label\n"
            "    length: str = memory.objects().objects[0].position\n"
        )
        self.assertEqual(self.lines_with_mistakes(program), [7, 8, 9])


if __name__ == "__main__":
    unittest.main()

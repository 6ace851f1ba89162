"""The package as a whole: documentation, types."""

import ast
import builtins
import inspect
import os
import pathlib
import subprocess
import unittest

import loci


class Package(unittest.TestCase):
    def setUp(self):
        self.stub = ast.parse(pathlib.Path(loci.__file__).with_suffix(".pyi").read_text())

    def test_stubs_declare_all_that_there_is(self):
        declared = {node.name: node for node in self.stub.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        self.assertEqual(sorted(declared), sorted(loci.__all__))
        for name, node in declared.items():
            if isinstance(node, ast.ClassDef):
                members = {each.name for each in node.body if isinstance(each, ast.FunctionDef)}
                members |= {each.target.id for each in node.body if isinstance(each, ast.AnnAssign)}
                public = {each for each in vars(getattr(loci, name)) if not each.startswith("_")}
                self.assertLessEqual(public, members, name)

    def test_the_version_is_that_of_the_programs(self):
        program = pathlib.Path(os.environ["LOCI_BIN_DIR"]) / "loci-memory"
        said = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout
        self.assertIn(loci.__version__, said)

    def test_types_in_stubs_are_known(self):
        known = set(loci.__all__) | set(dir(builtins))
        for node in ast.walk(self.stub):
            if isinstance(node, (ast.Import, ast.ImportFrom)):
                known.update(alias.name for alias in node.names)
        names = set()
        for node in ast.walk(self.stub):
            if isinstance(node, ast.FunctionDef):
                annotations = [each.annotation for each in [*node.args.args, *node.args.kwonlyargs]] + [node.returns]
                for annotation in filter(None, annotations):
                    names.update(each.id for each in ast.walk(annotation) if isinstance(each, ast.Name))
        self.assertEqual(names - known, set())

    def test_everything_is_documented(self):
        for name in loci.__all__:
            member = getattr(loci, name)
            self.assertTrue(inspect.getdoc(member), name)
            if isinstance(member, type):
                for each, value in vars(member).items():
                    if callable(value) and not each.startswith("_"):
                        self.assertTrue(inspect.getdoc(value), f"{name}.{each}")


if __name__ == "__main__":
    unittest.main()

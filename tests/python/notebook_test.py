"""The tutorial works as printed, and holds no outputs."""

import contextlib
import io
import json
import os
import unittest

from support import SOURCE, FolderTest


class Notebook(FolderTest):
    def test_all_cells_run(self):
        (self.folder / "apps").symlink_to(SOURCE / "apps")
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(self.folder)
        notebook = json.loads((SOURCE / "docs/python-tutorial.ipynb").read_text())
        printed, names = io.StringIO(), {}
        with contextlib.redirect_stdout(printed):
            for cell in notebook["cells"]:
                if cell["cell_type"] == "code":
                    exec(compile("".join(cell["source"]), cell["id"], "exec"), names)
                    self.assertEqual((cell["outputs"], cell["execution_count"]), ([], None))
        for expected in ("counter_1", "desk", "3 frames", "fire box", "object_2", "opens 0."):
            self.assertIn(expected, printed.getvalue())


if __name__ == "__main__":
    unittest.main()

"""Errors of one line for arguments of wrong types, of which pybind11 reports all that it knows."""

import functools
import re

from ._loci import Error


def _in_one_line(function, name):
    @functools.wraps(function)
    def call(*args, **keywords):
        try:
            return function(*args, **keywords)
        except TypeError as error:
            taken = re.search(r"incompatible \w+ arguments.*?1\. [\w.]*(\(.*?\))( -> .*?)?\n", str(error), re.S)
            if not taken:
                raise
            parameters = re.sub(r"self: [\w.]+(, )?|loci\._loci\.", "", taken[1])
            raise Error(f"{name}: an argument is missing or of a wrong type; it takes {parameters}") from None

    return call


def shorten_errors(module) -> None:
    """Of all functions, methods and constructors of a library."""
    for name, member in list(vars(module).items()):
        if isinstance(member, type):
            for each, function in list(vars(member).items()):
                called = name if each == "__init__" else f"{name}.{each.strip('_')}"
                if type(function).__name__ == "instancemethod":
                    setattr(member, each, _in_one_line(function, called))
                elif isinstance(function, staticmethod):
                    setattr(member, each, staticmethod(_in_one_line(function.__func__, called)))
        elif type(member).__name__ == "builtin_function_or_method":
            setattr(module, name, _in_one_line(member, name.strip("_")))

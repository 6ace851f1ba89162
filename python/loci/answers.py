"""What questions answer: a class for each kind of record, with its fields. Their declarations are those of the C++
library; a field that is Optional is None where an answer leaves it out.

    answer: loci.answers.WhereAnswer = memory.where("red cup")
    found: loci.answers.LocatedObject = answer.objects[0]
"""

import json
import keyword
from typing import Any, Dict, List, Literal, Optional

from . import _loci


class Fields(dict):
    """Named values, also as attributes: `answer.objects[0].place` is `answer["objects"][0]["place"]`."""

    def __getattr__(self, name: str) -> Any:
        key = name[:-1] if keyword.iskeyword(name[:-1]) else name
        if key in self:
            return self[key]
        if name in type(self).__dict__.get("__annotations__", {}):
            return None
        raise AttributeError(f"there is no '{name}'; there are: {', '.join(self)}")

    def __dir__(self):
        return [*super().__dir__(), *self]


class Record(Fields):
    """Named values that no class declares."""

    def __getattr__(self, name: str) -> Any:
        return super().__getattr__(name)


class Answer(Fields):
    """The answer to a question: its values, and as str() the same in words."""

    def __init__(self, values: dict, text: str):
        super().__init__(values)
        super().__setattr__("_text", text)

    def __str__(self) -> str:
        return self._text

    def _repr_pretty_(self, printer, cycle):
        printer.text(self._text.rstrip())


def read(text):
    """JSON as records without a class."""
    return json.loads(text, object_hook=Record)


def python_name(name):
    """What Python reserves gets an underscore behind it."""
    name = name.replace("-", "_")
    return name + "_" if keyword.iskeyword(name) else name


declared = read(_loci._questions())  # the questions, and the JSON Schema of their answers
_schemas = declared["$defs"]
_asked = {declared.sentence: ["ask"]}  # the questions that a class answers
for _question in declared.questions:
    _asked.setdefault(_question.answer, []).append(_question.name)
_PLAIN = {"string": str, "number": float, "integer": int, "boolean": bool}


def _name_of(schema):
    return schema["$ref"].rsplit("/", 1)[1]


def _type_of(schema):
    """The type of what a schema describes."""
    if "$ref" in schema:
        return class_of(_name_of(schema))
    if "enum" in schema:
        return Literal[tuple(schema.enum)]
    if schema.get("type") == "array":
        return List[_type_of(schema["items"])]
    if schema.get("type") == "object":
        return Dict[str, _type_of(schema.additionalProperties)]
    return _PLAIN[schema.type] if "type" in schema else Any


def class_of(name):
    """The class of a record, made when it is needed first."""
    if name not in globals():
        types = {}
        for field, schema in _schemas[name].properties.items():
            kind = _type_of(schema)
            types[python_name(field)] = kind if field in _schemas[name].required else Optional[kind]
        text = f"The answer to {', '.join(_asked[name])}." if name in _asked else "A part of answers."
        base = Answer if name in _asked else Fields
        globals()[name] = type(name, (base,), {"__module__": __name__, "__doc__": text, "__annotations__": types})
    return globals()[name]


def _typed(value, schema):
    """A value as its schema has it."""
    if "$ref" in schema:
        return class_of(_name_of(schema))(_fields(value, _name_of(schema)))
    if schema.get("type") == "array":
        return [_typed(each, schema["items"]) for each in value]
    return value


def _fields(values, name):
    properties = _schemas[name].properties
    return {field: _typed(value, properties[field]) for field, value in values.items()}


def answer(name, text, data):
    """An answer of this class, of its text and its JSON."""
    return class_of(name)(_fields(read(data), name), text)


__all__ = sorted(_schemas)
for _name in __all__:
    class_of(_name)

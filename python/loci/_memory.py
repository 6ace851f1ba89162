"""Questions as methods, and what they return. Their declarations are those of the C++ library."""

import collections.abc
import datetime
import inspect
import io
import numbers
import os
import tempfile
from typing import Any, Callable, Iterable, Iterator, List, Optional, Sequence, Union

from . import _loci, answers
from ._json import dumps, time_text
from ._loci import Error, Memory, Scene
from .answers import Record, python_name, read


class NotUnderstood(Error):
    """A sentence that is no known question; `nearest` are sentences that are."""

    nearest: List[str]

    def __init__(self, text: str, nearest: List[str]):
        super().__init__(text)
        self.nearest = nearest


def _argument(value):
    """A value as people write it."""
    if isinstance(value, datetime.datetime):
        return time_text(value)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, str):
        return value
    if isinstance(value, numbers.Number):
        return str(value)
    try:
        if not isinstance(value, (bytes, bytearray)):
            return ",".join(repr(float(each)) for each in value)
    except (TypeError, ValueError):
        pass
    raise Error(f"{value!r} is neither a text, a number, a time nor a list of numbers")


_Time = Union[datetime.datetime, str]
_TYPES = {
    "file": Union[str, os.PathLike],
    "length": Union[str, float],
    "number": Union[str, int],
    "point": Union[str, Sequence[float]],
    "spot": Union[str, Sequence[float]],
    "time": _Time,
}


def _signature(parameters, result, optional):
    """Parameters that the command takes without a name by position or name, the others of the kind `optional`."""
    kinds = [inspect.Parameter("self", inspect.Parameter.POSITIONAL_OR_KEYWORD)]
    for each in sorted(parameters, key=lambda each: (not each.required, not each.positional)):
        name, annotation = python_name(each.name), _TYPES.get(each.type, str)
        kind = inspect.Parameter.POSITIONAL_OR_KEYWORD if each.required or each.positional else optional
        if each.required:
            kinds.append(inspect.Parameter(name, kind, annotation=annotation))
        else:
            kinds.append(inspect.Parameter(name, kind, default=None, annotation=Optional[annotation]))
    return inspect.Signature(kinds, return_annotation=result)


def _documentation(declared):
    lines = [f"{declared.description}.", ""]
    for parameter in declared.parameters:
        default = f"; default: {parameter.default}" if "default" in parameter else ""
        choices = f"; one of {', '.join(parameter.choices)}" if "choices" in parameter else ""
        lines.append(f"{python_name(parameter.name)}: {parameter.help} ({parameter.type}{default}{choices})")
    return "\n".join(lines)


def _add_method(owner, declared, result, call, optional=inspect.Parameter.KEYWORD_ONLY):
    """Makes a declaration a method; `call(self, arguments)` gets its arguments as text by name."""
    signature = _signature(declared.parameters, result, optional)
    names = {python_name(parameter.name): parameter.name for parameter in declared.parameters}

    def method(*args, **keywords):
        try:
            bound = signature.bind(*args, **keywords).arguments
        except TypeError as error:
            raise TypeError(f"{method.__name__}(): {error}; it takes {signature}") from None
        given = {names[name]: _argument(value) for name, value in bound.items() if name != "self" and value is not None}
        return call(bound["self"], given)

    method.__name__ = python_name(declared.name)
    method.__qualname__ = f"{owner.__name__}.{method.__name__}"
    method.__module__ = "loci"
    method.__doc__ = _documentation(declared)
    method.__signature__ = signature
    setattr(owner, method.__name__, method)


class Edits:
    """Corrections of a memory that is open for writing: `memory.edit.merge("object_3", "object_7")`.

    What people say of identities is evidence: the belief is computed again from the first scene that it concerns.
    Each edit can be undone.
    """

    def __init__(self, memory: Memory):
        self._memory = memory

    def list(self) -> Record:
        """The edits that hold (`done`, in order) and those that were undone."""
        return read(self._memory._edits())


def _add_question(declared):
    _add_method(
        Memory,
        declared,
        answers.class_of(declared.answer),
        lambda memory, given: answers.answer(declared.answer, *memory._answer(declared.name, given)),
    )


def _add_edit(declared):
    _add_method(
        Edits,
        declared,
        Record,
        lambda edits, given: read(edits._memory._edit(declared.name, given)),
        inspect.Parameter.POSITIONAL_OR_KEYWORD,
    )


for _question in answers.declared.questions:
    _add_question(_question)
for _edit in read(_loci._edits()):
    _add_edit(_edit)


def _edits(self: Memory) -> Edits:
    """Corrections, when the memory is open for writing."""
    return Edits(self)


def _ask(
    self: Memory, sentence: str, *, before: Sequence[str] = (), at: _Time = "", known_at: _Time = ""
) -> answers.SentenceAnswer:
    """Answers a question in English: `memory.ask("Where is the red cup?")`.

    before: sentences that were asked before it, for what "it" means
    at, known_at: as for the other questions

    NotUnderstood when the sentence is no known question.
    """
    if not isinstance(sentence, str):
        raise Error(f"a question is a text, not {sentence!r}")
    if isinstance(before, str) or not all(isinstance(each, str) for each in before):
        raise Error("before is a list of sentences")
    text, data = self._answer_sentences([*before, sentence], _argument(at), _argument(known_at))[-1]
    answer = answers.answer(answers.declared.sentence, text, data)
    if not answer.understood:
        raise NotUnderstood(f"'{sentence}' is not understood; ask for example: {answer.nearest[0]}", answer.nearest)
    return answer


def _teach(self: Memory, object: str, class_name: str) -> Record:
    """Teaches a class by example: what looks like the object is called so, too. The memory is open for writing.

    Returns what it led to: the objects that were named, with probabilities.
    """
    return read(self._teach(object, class_name))


def _iterate(self: Memory) -> Iterator[Scene]:
    """All scenes in order of time."""
    return self.iter_scenes()


Memory.ask = _ask
Memory.edit = property(_edits)
Memory.teach = _teach
Memory.__iter__ = _iterate


def _is_in_database(path):
    return isinstance(path, str) and path.startswith(("postgresql://", "postgres://"))


_DATABASE_IS_READ = "a memory in a database is read: the robot's file is written, and pushed"


def open(
    path: Union[str, os.PathLike], write: bool = False, *, now: Optional[_Time] = None
) -> Memory:
    """Opens a memory, a file *.loci: for reading, or for writing, too.

    postgresql://…/DATABASE?robot=NAME opens a memory of a database for reading: its present state, as a local copy.
    Use it in a `with` statement, or close() it. A memory that is opened for writing is made where it is missing.
    now: transaction time of what is written; the clock without it
    """
    if _is_in_database(path):
        if write:
            raise Error(_DATABASE_IS_READ)
        cache = os.environ.get("XDG_CACHE_HOME", "")
        if not os.path.isabs(cache):  # what the XDG base directory specification says of it
            cache = os.path.expanduser("~/.cache")
        path = _loci._replica(path, os.path.join(cache, "loci", "fleet"))
    return Memory(path, write, now=now)


def ingest(
    detections: Union[str, os.PathLike, Iterable[dict]],
    memory: Union[str, os.PathLike],
    *,
    map: Union[str, os.PathLike] = "",
    recording: Union[str, os.PathLike] = "",
    progress: Optional[Callable[[float, str], Optional[bool]]] = None,
    now: Optional[_Time] = None,
    **options: Any,
) -> Record:
    """Adds the detections of another system to a memory (docs/detections.md), which is not open meanwhile.

    detections: a file of JSON Lines, COCO or YOLO, or an iterable of scenes as dictionaries, in which times may be
        datetime and positions arrays of numpy
    memory: the file, made where it is missing
    map: URDF for the places; recording: what was detected in, where detections have no positions
    progress: called with a fraction and a text; False stops
    options: as of `loci-memory ingest`: strict, resume, noise_m, ...

    Returns the report.
    """
    if _is_in_database(memory):
        raise Error(_DATABASE_IS_READ)
    if isinstance(detections, (str, os.PathLike)):
        return read(_loci._ingest(detections, "", memory, map, recording, progress, now, **options))
    if isinstance(detections, collections.abc.Mapping) or not isinstance(detections, collections.abc.Iterable):
        raise Error("detections are a file or a list of scenes: [{'time': ..., 'detections': [...]}, ...]")
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "detections.jsonl")
        with io.open(file, "w", encoding="utf-8") as lines:
            for number, scene in enumerate(detections, 1):
                lines.write(dumps(scene, f"detections:{number}") + "\n")
        return read(_loci._ingest(file, "detections", memory, map, recording, progress, now, **options))

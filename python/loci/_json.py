"""Values of Python as JSON, which is how the library takes them."""

import datetime
import json
import os

from ._loci import Error


def time_text(time: datetime.datetime) -> str:
    """A time as ISO 8601."""
    if time.tzinfo is None:
        raise Error("a time needs a zone: datetime(..., tzinfo=timezone.utc)")
    return time.isoformat()


def _plain(value):
    """What JSON has no form for: times, paths, and arrays and numbers of numpy."""
    if isinstance(value, datetime.datetime):
        return time_text(value)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a {type(value).__name__} cannot be given here: numbers, texts, lists and dictionaries can")


def dumps(value, what: str, *, finite: bool = False) -> str:
    """A value as JSON. Error that begins with `what` where it has none, or where it is to be finite and is not."""
    try:
        return json.dumps(value, default=_plain, allow_nan=not finite)
    except ValueError as error:
        reason = "is not a finite number" if str(error).startswith("Out of range float") else str(error)
        raise Error(f"{what}: {reason}") from None
    except (TypeError, RecursionError) as error:
        raise Error(f"{what}: {error}") from None

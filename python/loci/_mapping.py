"""Maps with their sidecar, and recordings."""

import os
from typing import Any, Union

from . import _loci
from ._json import dumps
from ._loci import Map, Recording
from .answers import Record, read


def _read_map(path: Union[str, os.PathLike]) -> Map:
    """Reads a URDF, and its sidecar (`kitchen.semantic.json` beside `kitchen.urdf`) where there is one.

    `map.semantics` is what the sidecar says: a dictionary, None without one. Change it and write() the map.
    """
    map = Map._read(path)
    map.semantics = read(map._sidecar) if map._sidecar else None
    return map


def _write(self: Map, path: Union[str, os.PathLike], *, force: bool = False) -> None:
    """Writes the URDF, and the sidecar when `semantics` is set. Error, and nothing is written, when the links and
    joints are no tree, a sidecar speaks of links that there are not, or a file is there that loci did not write and
    `force` is not set."""
    semantics = getattr(self, "semantics", None)
    self._write(path, dumps(semantics, "semantics", finite=True) if semantics else "", force)


Map.read = staticmethod(_read_map)
Map.write = _write


def open_recording(path: Union[str, os.PathLike], **options: Any) -> Recording:
    """Opens a recording of any known layout: its frames by number, or one after the other.

    options: as of `loci-perceive info`: topics, poses, up, color_delay_s, seconds_apart, start
    """
    return _loci._open_recording(path, **options)


def _info(self: Recording) -> Record:
    """What the recording is, and what was guessed about it."""
    return read(self._info())


Recording.info = _info

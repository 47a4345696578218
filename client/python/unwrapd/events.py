"""The event stream format of the HTML standard, as far as the server uses it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Event:
    name: str
    data: dict[str, Any]
    id: str | None = None


def events_of(lines: Iterable[bytes]) -> Iterator[Event]:
    """The events of one connection, as they arrive."""
    fields: dict[str, str] = {}
    for line in lines:
        text = line.decode().rstrip("\r\n")
        name, _, value = text.partition(":")
        if name:  # a comment has none
            value = value.removeprefix(" ")
            fields[name] = f"{fields[name]}\n{value}" if name in fields else value
        elif not text and "event" in fields and "data" in fields:
            yield Event(fields["event"], json.loads(fields["data"]), fields.get("id"))
        if not text:
            fields = {}

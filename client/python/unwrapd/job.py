"""A job from its submission to its end, over connections that break and servers that are full."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from .asset import Form, SourceText
from .connection import Connection, Patience, lines, patiently, read
from .error import UnwrapdError, unexpected, unreachable
from .events import Event, events_of

OK = 200
FINAL = ("succeeded", "failed", "cancelled")

Job = dict[str, Any]


@dataclass(frozen=True)
class Progress:
    """fraction: share of the job that is done; never falls. event, data: as the server tells them."""

    fraction: float
    event: str
    data: dict[str, Any]


OnProgress = Callable[[Progress], None]


def json_of(status: int, body: bytes) -> Any:
    """The JSON of an answer; a proxy may have sent a page of its own."""
    try:
        return json.loads(body)
    except ValueError:
        raise unexpected(status) from None


def download(connection: Connection, path: str, headers: Mapping[str, str] | None = None) -> bytes:
    """A file of a job, read whole."""

    def attempt() -> bytes:
        with connection.call("GET", path, headers) as answer:
            return read(answer)

    return patiently(connection, attempt)


def submit(connection: Connection, form: Form | SourceText, name: str, path: str) -> Job:
    """Sends the asset. A request that is sent again gets the job that it made before."""
    headers = {**form.headers(), "Accept": "application/json", "Idempotency-Key": name}

    def attempt() -> Job:
        with connection.call("POST", path, headers, form) as answer:
            return json_of(answer.status, read(answer))

    return patiently(connection, attempt)


class _Follower:
    """Reads events where the last connection ended."""

    def __init__(self, connection: Connection, on_progress: OnProgress | None) -> None:
        self.patience = Patience(connection.retries)
        self._connection = connection
        self._on_progress = on_progress
        self._last_id: str | None = None
        self._fraction = 0.0

    def read(self, job: Job) -> Job:
        """The job at its end. Raises UnwrapdError if the connection ends before."""
        headers = {"Accept": "text/event-stream"}
        if self._last_id is not None:
            headers["Last-Event-ID"] = self._last_id
        with self._connection.call("GET", job["links"]["events"], headers) as answer:
            for event in events_of(lines(answer)):
                self._tell(event)
                if event.name in FINAL:
                    return event.data
        raise unreachable("the events ended before the job")

    def _tell(self, event: Event) -> None:
        self.patience.renew()
        self._last_id = event.id if event.id is not None else self._last_id
        told = 1.0 if event.name == "succeeded" else event.data.get("fraction", 0.0)
        self._fraction = max(self._fraction, told)
        if self._on_progress:
            self._on_progress(Progress(self._fraction, event.name, event.data))


def follow(connection: Connection, job: Job, on_progress: OnProgress | None) -> Job:
    """Follows the job to its end. While no stream is free, its state is asked for."""
    follower = _Follower(connection, on_progress)
    while True:
        try:
            return follower.read(job)
        except UnwrapdError as error:
            follower.patience.after(error)
            if error.code != "too_many_streams":
                continue
        now: Job = json_of(OK, download(connection, job["links"]["self"]))
        if now["state"] in FINAL:
            return now
        follower.patience.renew()


def _cancel(connection: Connection, job: Job) -> None:
    """Asks the server to stop; that it cannot be reached is no error of the caller's."""
    try:
        with connection.call("DELETE", job["links"]["self"]):
            pass
    except UnwrapdError:
        pass


def run_job(
    connection: Connection, form: Form | SourceText, name: str, on_progress: OnProgress | None, path: str = "/v1/jobs"
) -> Job:
    """Submits and follows a job. Raises UnwrapdError unless it succeeds; what on_progress raises, or
    Ctrl-C, cancels the job."""
    job = submit(connection, form, name, path)
    try:
        ended = follow(connection, job, on_progress)
    except UnwrapdError:
        raise
    except BaseException:
        _cancel(connection, job)
        raise
    if problem := ended.get("problem"):
        raise UnwrapdError(problem)
    return {**ended, "links": job["links"]}  # those of a ticket are signed



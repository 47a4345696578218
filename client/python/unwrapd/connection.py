"""One request to the server, and when to send it again."""

from __future__ import annotations

import http.client
import os
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TypeVar
from urllib.parse import SplitResult, urljoin, urlsplit

from .error import UNREACHABLE, UnwrapdError, error_of, unexpected, unreachable

T = TypeVar("T")

FIRST_PAUSE = 0.25  # seconds, doubled each time
LONGEST_PAUSE = 5.0
LONGEST_RETRY_AFTER = 60
GATEWAYS = (502, 504)  # a proxy without a server behind it
SILENCE = 60.0  # seconds; the server says something every 15
REDIRECTS = (301, 302, 303, 307, 308)
MOST_REDIRECTS = 5


def default_server() -> str:
    return os.environ.get("UNWRAPD_SERVER", "http://127.0.0.1:8080")


@contextmanager
def network_errors() -> Iterator[None]:
    """What breaks while the network is used becomes an UnwrapdError."""
    try:
        yield
    except (OSError, http.client.HTTPException) as error:
        raise unreachable(str(error) or type(error).__name__) from error


def _origin(address: SplitResult) -> tuple[str, str | None, int]:
    return address.scheme, address.hostname, address.port or (443 if address.scheme == "https" else 80)


def read(answer: http.client.HTTPResponse) -> bytes:
    with network_errors():
        return answer.read()


def lines(answer: http.client.HTTPResponse) -> Iterator[bytes]:
    """The lines of a stream, as they arrive."""
    while True:
        with network_errors():
            line = answer.readline()
        if not line:
            return
        yield line


@dataclass(frozen=True)
class Connection:
    """Where the server is, and how long to be patient with it."""

    server: str
    key: str | None = None
    retries: int = 10

    def __post_init__(self) -> None:
        if not self.server.lower().startswith(("http://", "https://")):
            raise ValueError(f"server is an address with http:// or https://, not {self.server}")

    @contextmanager
    def call(
        self,
        method: str,
        path: str,
        headers: Mapping[str, str] | None = None,
        body: Iterable[bytes] | None = None,
    ) -> Iterator[http.client.HTTPResponse]:
        """Sends one request. Raises UnwrapdError for any answer but one of success.

        A GET follows redirects. The key is sent to the server's own origin alone.
        """
        url = self.server.rstrip("/") + path
        for _ in range(MOST_REDIRECTS + 1):
            with self._ask(method, url, headers, body) as answer:
                target = answer.headers["Location"] if answer.status in REDIRECTS and method == "GET" else None
                if not target:
                    if answer.status >= 300:
                        with network_errors():
                            raise error_of(answer.status, answer.headers["Retry-After"], answer.read())
                    yield answer
                    return
            url = urljoin(url, target)
        raise unexpected(answer.status)

    @contextmanager
    def _ask(
        self, method: str, url: str, headers: Mapping[str, str] | None, body: Iterable[bytes] | None
    ) -> Iterator[http.client.HTTPResponse]:
        address = urlsplit(url)
        if address.scheme not in ("http", "https"):
            raise unreachable(f"a redirect to {address.scheme}")
        target = (address.path or "/") + (f"?{address.query}" if address.query else "")
        kind = http.client.HTTPSConnection if address.scheme == "https" else http.client.HTTPConnection
        sent = dict(headers or {})
        if self.key and _origin(address) == _origin(urlsplit(self.server)):
            sent["Authorization"] = f"Bearer {self.key}"
        line = kind(address.hostname or "", address.port, timeout=SILENCE)
        try:
            with network_errors():
                line.request(method, target, body, sent)
                answer = line.getresponse()
            yield answer
        finally:
            line.close()


class Patience:
    """Counts failures in a row, and waits after each."""

    def __init__(self, retries: int) -> None:
        self._retries = retries
        self._failures = 0

    def renew(self) -> None:
        """Forgets the failures: there was progress."""
        self._failures = 0

    def after(self, error: UnwrapdError) -> None:
        """Waits until the next attempt; raises the error again if there is none."""
        pause = self._pause_after(error)
        self._failures += 1
        if pause is None or self._failures > self._retries:
            raise error
        time.sleep(pause)

    def _pause_after(self, error: UnwrapdError) -> float | None:
        if error.retry_after:
            return min(error.retry_after, LONGEST_RETRY_AFTER)
        if error.code == UNREACHABLE or error.status in GATEWAYS:
            return min(FIRST_PAUSE * 2**self._failures, LONGEST_PAUSE)
        return None


def patiently(connection: Connection, attempt: Callable[[], T]) -> T:
    """Attempts until one succeeds, or fails for good. An attempt must be safe to make again."""
    patience = Patience(connection.retries)
    while True:
        try:
            return attempt()
        except UnwrapdError as error:
            patience.after(error)

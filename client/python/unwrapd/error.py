"""The one exception of this package."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

UNREACHABLE = "unreachable"
UNEXPECTED_ANSWER = "unexpected_answer"


class UnwrapdError(Exception):
    """Whatever went wrong between here and the server, and on it (RFC 9457).

    code: stable; one of the contract's ErrorCode, `unreachable` or `unexpected_answer`.
    status: of HTTP; 0 without an answer. pointer: the place in the options or the document.
    job: the id of the job. retry_after: seconds after which the server wants the request again.
    """

    def __init__(self, problem: Mapping[str, Any], retry_after: int | None = None) -> None:
        self.code: str = problem["code"]
        self.status: int = problem["status"]
        self.detail: str = problem["detail"]
        self.pointer: str | None = problem.get("pointer")
        self.job: str | None = problem.get("job")
        self.retry_after = retry_after
        place = f", at {self.pointer}" if self.pointer else ""
        super().__init__(f"{self.detail} ({self.code}{place})")


def error_of(status: int, retry_after: str | None, body: bytes) -> UnwrapdError:
    """The error that an answer tells."""
    seconds = int(retry_after) if retry_after and retry_after.isdigit() else None
    try:
        problem = json.loads(body)
        return UnwrapdError(problem, seconds)
    except (ValueError, KeyError, TypeError):
        return unexpected(status, seconds)


def unexpected(status: int, retry_after: int | None = None) -> UnwrapdError:
    """An answer that is none of the server's."""
    detail = f"Status {status} is not an answer of unwrapd; check the address."
    return UnwrapdError({"code": UNEXPECTED_ANSWER, "status": status, "detail": detail}, retry_after)


def unreachable(cause: object) -> UnwrapdError:
    """A connection that could not be made, or broke."""
    detail = f"The server cannot be reached: {cause}"
    return UnwrapdError({"code": UNREACHABLE, "status": 0, "detail": detail})

# SPDX-License-Identifier: MIT
"""Errors of the library as exceptions."""

from __future__ import annotations


class Error(Exception):
    """A call failed. Nothing was changed.

    Attributes
    ----------
    subject : str
        What is at fault: a file, an argument, a function.
    problem : str
        What the matter is.
    remedy : str
        What would mend it; may be empty.
    status : str
        Name of the status in C, such as ``"ES_ERROR_FAILED"``.
    """

    def __init__(self, subject: str, problem: str, remedy: str = "", status: str = "") -> None:
        super().__init__(subject, problem, remedy, status)
        self.subject = subject
        self.problem = problem
        self.remedy = remedy
        self.status = status

    def __str__(self) -> str:
        line = f"{self.subject}: {self.problem}" if self.subject else self.problem
        return f"{line}; {self.remedy}" if self.remedy else line


class ArgumentError(Error, ValueError):
    """A number, shape or size is out of range, or not finite."""


class OutOfRange(Error, IndexError):
    """An index is beyond what there is."""


class UnknownName(Error, KeyError):
    """There is nothing of that name."""

    __str__ = Error.__str__


class Cancelled(Error):
    """A progress callback returned False."""


class OutOfMemory(Error, MemoryError):
    """There is not enough memory."""


class MissingPackage(Error, ImportError):
    """A package that is only needed here is not installed."""

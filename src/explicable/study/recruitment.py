"""Where people come from: what recruitment platforms put into the link, and where people are sent back to.

What is missing is missing: nothing is invented.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from urllib.parse import quote

PARAMETERS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "plain": (),
        "prolific": ("PROLIFIC_PID", "STUDY_ID", "SESSION_ID"),
        "mturk": ("workerId", "assignmentId", "hitId"),
        "sona": ("survey_code",),
    }
)
"""The parameters of each platform's link; the first says who the person is."""

_TEMPLATES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "prolific": {name: "{{%" + name + "%}}" for name in PARAMETERS["prolific"]},
        "sona": {"survey_code": "%SURVEY_CODE%"},
    }
)
MTURK_HOSTS = ("https://www.mturk.com", "https://workersandbox.mturk.com")
"""Where pages of Mechanical Turk come from, which show a study in a frame."""

_VALUE = re.compile(r"[A-Za-z0-9_.:@-]{1,200}")
_FIELD = re.compile(r"\{(\w+)\}")
_MTURK_PREVIEW = "ASSIGNMENT_ID_NOT_AVAILABLE"


@dataclass(frozen=True, slots=True)
class Recruit:
    """What a platform told about a person, by parameter; empty where it told nothing."""

    platform: str
    values: Mapping[str, str]

    @property
    def person(self) -> tuple[str, str] | None:
        """Return the parameter that says who the person is, with its value."""
        names = PARAMETERS[self.platform][:1]
        return next(((name, self.values[name]) for name in names if name in self.values), None)


def read_parameters(platform: str, query: Mapping[str, str]) -> Recruit:
    """Take a platform's parameters from a link; values that are none are left out.

    Examples
    --------
    >>> recruit = read_parameters("prolific", {"PROLIFIC_PID": "5f0", "STUDY_ID": "{{%STUDY_ID%}}"})
    >>> recruit.values, recruit.person
    ({'PROLIFIC_PID': '5f0'}, ('PROLIFIC_PID', '5f0'))
    """
    values = {
        name: query[name]
        for name in PARAMETERS[platform]
        if name in query and _VALUE.fullmatch(query[name]) and query[name] != _MTURK_PREVIEW
    }
    return Recruit(platform, values)


def is_preview(platform: str, query: Mapping[str, str]) -> bool:
    """Tell whether somebody only looks at a task of Mechanical Turk that they have not accepted yet.

    Examples
    --------
    >>> is_preview("mturk", {"assignmentId": "ASSIGNMENT_ID_NOT_AVAILABLE"})
    True
    """
    return platform == "mturk" and query.get("assignmentId") == _MTURK_PREVIEW


def submit_address(query: Mapping[str, str]) -> str | None:
    """Return where a page in a frame of Mechanical Turk hands in an assignment; None if it is not told.

    Examples
    --------
    >>> submit_address({"turkSubmitTo": "https://www.mturk.com/"})
    'https://www.mturk.com/mturk/externalSubmit'
    >>> submit_address({"turkSubmitTo": "https://www.mturk.com.example"})
    """
    host = query.get("turkSubmitTo", "").rstrip("/")
    return f"{host}/mturk/externalSubmit" if host in MTURK_HOSTS else None


def link_template(platform: str, link: str) -> str:
    """Return the link to give to a platform, which fills in its parameters; Mechanical Turk adds them itself.

    Examples
    --------
    >>> link_template("sona", "https://lab.example/")
    'https://lab.example/?survey_code=%SURVEY_CODE%'
    """
    parameters = "&".join(f"{name}={value}" for name, value in _TEMPLATES.get(platform, {}).items())
    return f"{link}?{parameters}" if parameters else link


def return_link(template: str, code: str, values: Mapping[str, str]) -> str:
    """Fill in the link that leads back: ``{code}``, and the platform's own parameters.

    Examples
    --------
    >>> link = "https://pay.example/?cc={code}&id={survey_code}"
    >>> return_link(link, "K7", {"survey_code": "a&b"}), return_link(link, "K7", {})
    ('https://pay.example/?cc=K7&id=a%26b', 'https://pay.example/?cc=K7&id=')
    """
    known = {"code": code, **values}
    return _FIELD.sub(lambda field: quote(known.get(field[1], ""), safe=""), template)


def unknown_field(template: str, platform: str) -> str | None:
    """Return a field of a link that leads back which the platform does not fill; None if there is none.

    Examples
    --------
    >>> unknown_field("https://pay.example/?cc={code}&id={survey_code}", "prolific")
    'survey_code'
    """
    known = {"code", *PARAMETERS[platform]}
    return next((name for name in _FIELD.findall(template) if name not in known), None)

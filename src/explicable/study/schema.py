"""The tables of a study. Every row says whether it comes from a person or a simulated participant.

Times are seconds since 1970 (UTC); ``client_time`` is the participant's own clock. What a recruitment
platform told is apart, in ``recruits``; no network address is stored anywhere.
"""

from sqlalchemy import (
    Boolean,
    Column,
    Float,
    ForeignKey,
    Integer,
    MetaData,
    String,
    Table,
    Text,
    UniqueConstraint,
)

METADATA = MetaData(
    naming_convention={
        "ix": "ix_%(table_name)s_%(column_0_name)s",
        "uq": "uq_%(table_name)s_%(column_0_N_name)s",
        "fk": "fk_%(table_name)s_%(column_0_name)s",
        "pk": "pk_%(table_name)s",
    }
)


def _origin() -> Column[str]:
    return Column("origin", String(9), nullable=False)


SETTINGS = Table("settings", METADATA, Column("name", String(64), primary_key=True), Column("value", Text))

PARTICIPANTS = Table(
    "participants",
    METADATA,
    Column("id", String(64), primary_key=True),
    _origin(),
    Column("created", Float, nullable=False),
    Column("erased", Float),
)

RECRUITS = Table(
    "recruits",
    METADATA,
    Column("participant", ForeignKey("participants.id"), primary_key=True),
    Column("platform", String(16), nullable=False),
    Column("name", String(64), primary_key=True),
    Column("value", String(200), nullable=False, index=True),
)

SESSIONS = Table(
    "sessions",
    METADATA,
    Column("id", String(43), primary_key=True),
    Column("participant", ForeignKey("participants.id"), nullable=False, index=True),
    _origin(),
    Column("condition", String(64), nullable=False),
    Column("stage", String(16), nullable=False, index=True),
    Column("position", Integer, nullable=False),
    Column("attempts", Integer, nullable=False),
    Column("revision", Integer, nullable=False),
    Column("start_request", String(64), nullable=False, unique=True),
    Column("code", String(16), nullable=False),
    Column("created", Float, nullable=False),
    Column("seen", Float, nullable=False, index=True),
    Column("study", String(64), nullable=False),
    Column("version", String(32), nullable=False),
    Column("seed", Integer, nullable=False),
)

ASSIGNMENTS = Table(
    "assignments",
    METADATA,
    Column("id", Integer, primary_key=True),
    Column("session", ForeignKey("sessions.id"), nullable=False),
    _origin(),
    Column("position", Integer, nullable=False),
    Column("task", String(64), nullable=False, index=True),
    Column("kind", String(8), nullable=False),
    Column("status", String(8), nullable=False),
    Column("announced", Text),
    Column("started", Float),
    Column("ended", Float),
    UniqueConstraint("session", "position"),
)

STEPS = Table(
    "steps",
    METADATA,
    Column("assignment", ForeignKey("assignments.id"), primary_key=True),
    Column("number", Integer, primary_key=True, autoincrement=False),
    _origin(),
    Column("agent", String(200), nullable=False),
    Column("operator", Text, nullable=False),
    Column("server_time", Float, nullable=False),
)

LABELS = Table(
    "labels",
    METADATA,
    Column("assignment", ForeignKey("assignments.id"), primary_key=True),
    Column("number", Integer, primary_key=True, autoincrement=False),
    _origin(),
    Column("explicable", Boolean, nullable=False),
    Column("request", String(64), nullable=False),
    Column("latency_s", Float),
    Column("client_time", Float),
    Column("server_time", Float, nullable=False),
)

ANSWERS = Table(
    "answers",
    METADATA,
    Column("session", ForeignKey("sessions.id"), primary_key=True),
    Column("stage", String(16), primary_key=True),
    Column("attempt", Integer, primary_key=True, autoincrement=False),
    Column("name", String(64), primary_key=True),
    _origin(),
    Column("value", Text, nullable=False),
    Column("server_time", Float, nullable=False),
)

EVENTS = Table(
    "events",
    METADATA,
    Column("id", Integer, primary_key=True),
    Column("session", ForeignKey("sessions.id"), nullable=False),
    _origin(),
    Column("kind", String(32), nullable=False),
    Column("request", String(64)),
    Column("data", Text, nullable=False),
    Column("latency_s", Float),
    Column("client_time", Float),
    Column("server_time", Float, nullable=False),
    UniqueConstraint("session", "request"),
)

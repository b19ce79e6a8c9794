"""The first tables.

Revision ID: 0001
Revises:
"""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the change."""
    op.create_table(
        "participants",
        sa.Column("id", sa.String(length=64), nullable=False),
        sa.Column("origin", sa.String(length=9), nullable=False),
        sa.Column("created", sa.Float(), nullable=False),
        sa.Column("erased", sa.Float(), nullable=True),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_participants")),
    )
    op.create_table(
        "settings",
        sa.Column("name", sa.String(length=64), nullable=False),
        sa.Column("value", sa.Text(), nullable=True),
        sa.PrimaryKeyConstraint("name", name=op.f("pk_settings")),
    )
    op.create_table(
        "recruits",
        sa.Column("participant", sa.String(length=64), nullable=False),
        sa.Column("platform", sa.String(length=16), nullable=False),
        sa.Column("name", sa.String(length=64), nullable=False),
        sa.Column("value", sa.String(length=200), nullable=False),
        sa.ForeignKeyConstraint(["participant"], ["participants.id"], name=op.f("fk_recruits_participant")),
        sa.PrimaryKeyConstraint("participant", "name", name=op.f("pk_recruits")),
    )
    with op.batch_alter_table("recruits", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_recruits_value"), ["value"], unique=False)

    op.create_table(
        "sessions",
        sa.Column("id", sa.String(length=43), nullable=False),
        sa.Column("participant", sa.String(length=64), nullable=False),
        sa.Column("origin", sa.String(length=9), nullable=False),
        sa.Column("condition", sa.String(length=64), nullable=False),
        sa.Column("stage", sa.String(length=16), nullable=False),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("attempts", sa.Integer(), nullable=False),
        sa.Column("revision", sa.Integer(), nullable=False),
        sa.Column("start_request", sa.String(length=64), nullable=False),
        sa.Column("code", sa.String(length=16), nullable=False),
        sa.Column("created", sa.Float(), nullable=False),
        sa.Column("seen", sa.Float(), nullable=False),
        sa.Column("study", sa.String(length=64), nullable=False),
        sa.Column("version", sa.String(length=32), nullable=False),
        sa.Column("seed", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(["participant"], ["participants.id"], name=op.f("fk_sessions_participant")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_sessions")),
        sa.UniqueConstraint("start_request", name=op.f("uq_sessions_start_request")),
    )
    with op.batch_alter_table("sessions", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_sessions_participant"), ["participant"], unique=False)
        batch_op.create_index(batch_op.f("ix_sessions_seen"), ["seen"], unique=False)
        batch_op.create_index(batch_op.f("ix_sessions_stage"), ["stage"], unique=False)

    op.create_table(
        "answers",
        sa.Column("session", sa.String(length=43), nullable=False),
        sa.Column("stage", sa.String(length=16), nullable=False),
        sa.Column("attempt", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("name", sa.String(length=64), nullable=False),
        sa.Column("origin", sa.String(length=9), nullable=False),
        sa.Column("value", sa.Text(), nullable=False),
        sa.Column("server_time", sa.Float(), nullable=False),
        sa.ForeignKeyConstraint(["session"], ["sessions.id"], name=op.f("fk_answers_session")),
        sa.PrimaryKeyConstraint("session", "stage", "attempt", "name", name=op.f("pk_answers")),
    )
    op.create_table(
        "assignments",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("session", sa.String(length=43), nullable=False),
        sa.Column("origin", sa.String(length=9), nullable=False),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("task", sa.String(length=64), nullable=False),
        sa.Column("kind", sa.String(length=8), nullable=False),
        sa.Column("status", sa.String(length=8), nullable=False),
        sa.Column("announced", sa.Text(), nullable=True),
        sa.Column("started", sa.Float(), nullable=True),
        sa.Column("ended", sa.Float(), nullable=True),
        sa.ForeignKeyConstraint(["session"], ["sessions.id"], name=op.f("fk_assignments_session")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_assignments")),
        sa.UniqueConstraint("session", "position", name=op.f("uq_assignments_session_position")),
    )
    with op.batch_alter_table("assignments", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_assignments_task"), ["task"], unique=False)

    op.create_table(
        "events",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("session", sa.String(length=43), nullable=False),
        sa.Column("origin", sa.String(length=9), nullable=False),
        sa.Column("kind", sa.String(length=32), nullable=False),
        sa.Column("request", sa.String(length=64), nullable=True),
        sa.Column("data", sa.Text(), nullable=False),
        sa.Column("latency_s", sa.Float(), nullable=True),
        sa.Column("client_time", sa.Float(), nullable=True),
        sa.Column("server_time", sa.Float(), nullable=False),
        sa.ForeignKeyConstraint(["session"], ["sessions.id"], name=op.f("fk_events_session")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_events")),
        sa.UniqueConstraint("session", "request", name=op.f("uq_events_session_request")),
    )
    op.create_table(
        "labels",
        sa.Column("assignment", sa.Integer(), nullable=False),
        sa.Column("number", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("origin", sa.String(length=9), nullable=False),
        sa.Column("explicable", sa.Boolean(), nullable=False),
        sa.Column("request", sa.String(length=64), nullable=False),
        sa.Column("latency_s", sa.Float(), nullable=True),
        sa.Column("client_time", sa.Float(), nullable=True),
        sa.Column("server_time", sa.Float(), nullable=False),
        sa.ForeignKeyConstraint(["assignment"], ["assignments.id"], name=op.f("fk_labels_assignment")),
        sa.PrimaryKeyConstraint("assignment", "number", name=op.f("pk_labels")),
    )
    op.create_table(
        "steps",
        sa.Column("assignment", sa.Integer(), nullable=False),
        sa.Column("number", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("origin", sa.String(length=9), nullable=False),
        sa.Column("agent", sa.String(length=200), nullable=False),
        sa.Column("operator", sa.Text(), nullable=False),
        sa.Column("server_time", sa.Float(), nullable=False),
        sa.ForeignKeyConstraint(["assignment"], ["assignments.id"], name=op.f("fk_steps_assignment")),
        sa.PrimaryKeyConstraint("assignment", "number", name=op.f("pk_steps")),
    )


def downgrade() -> None:
    """Take the change back."""
    op.drop_table("steps")
    op.drop_table("labels")
    op.drop_table("events")
    with op.batch_alter_table("assignments", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_assignments_task"))

    op.drop_table("assignments")
    op.drop_table("answers")
    with op.batch_alter_table("sessions", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_sessions_stage"))
        batch_op.drop_index(batch_op.f("ix_sessions_seen"))
        batch_op.drop_index(batch_op.f("ix_sessions_participant"))

    op.drop_table("sessions")
    with op.batch_alter_table("recruits", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_recruits_value"))

    op.drop_table("recruits")
    op.drop_table("settings")
    op.drop_table("participants")

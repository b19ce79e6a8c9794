"""Alembic's entry: migrates over the connection that `explicable.study.store.migrate` hands in."""

from alembic import context

from explicable.study.schema import METADATA

context.configure(
    connection=context.config.attributes["connection"], target_metadata=METADATA, render_as_batch=True
)
with context.begin_transaction():
    context.run_migrations()

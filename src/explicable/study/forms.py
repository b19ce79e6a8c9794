"""Reading the forms that pages send."""

from fastapi import Request


async def read_form(request: Request) -> dict[str, str]:
    """Return the text fields of a form, without null characters, which PostgreSQL can't store."""
    async with request.form(max_files=0, max_fields=200) as form:
        return {name: value.replace("\0", "") for name, value in form.items() if isinstance(value, str)}

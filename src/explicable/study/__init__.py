"""The online study: people watch or command a robot in a browser and say which of its steps make sense.

The pure core is `protocol` (the course of a session) and `game` (a task under way). `store`, with
`transaction`, `records`, `schema` and `writer`, is all that touches the database; `conduct` and `enrolment`
say what requests do to it; `app` puts together what speaks HTTP.
"""

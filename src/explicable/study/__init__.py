"""The online study: people watch or command a robot in a browser and say which of its steps make sense.

The pure core is `protocol` (the course of a session) and `game` (a task under way); `store` is the only
module that touches the database, `app` and `admin` the only ones that speak HTTP.
"""

"""Ports for servers that tests end and start again."""

import socket


def reserve_port():
    """Take a port of this machine that nobody else is given until the socket is closed; return both.

    The socket listens to nothing and shares the port with a server, which sets ``SO_REUSEADDR`` as all do.
    Without it, while the server is down the port is any other's to take; even a client that knocks at it may
    be given it for its own end, and then talks to itself.
    """
    reserved = socket.socket()
    reserved.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    reserved.bind(("127.0.0.1", 0))
    return reserved, reserved.getsockname()[1]

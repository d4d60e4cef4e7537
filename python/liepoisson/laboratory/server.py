"""One page at an address of this machine: nothing else is served, and only to who has the token of the address."""

from __future__ import annotations

import hmac
import re
import secrets
import socket
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from liepoisson.errors import OutputError
from liepoisson.formula.scalars import as_count
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.laboratory.pages import Page

HOST = "127.0.0.1"
_POLICY = re.compile(r'http-equiv="Content-Security-Policy" content="([^"]*)"')
_METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE", "CONNECT")
_SECONDS = 20.0
"""For one request: who is slower is let go."""


class PageServer(ThreadingHTTPServer):
    """A server of one page on the loopback interface.

    The path of the page is a random token; a request with another path or another host name is refused, so that no
    other page in the browser and no other user of the machine can read it.  `serve_forever()` answers until Ctrl-C.

    Example:
        >>> with lp.laboratory.PageServer(lp.laboratory.page_of_tops()) as server:
        ...     server.url.startswith("http://127.0.0.1:")
        True

    Args:
        page: The page.
        port: The port; 0 lets the system choose one.

    Attributes:
        url: The address to open.

    Raises:
        OutputError: the port is taken, or not to be had.
    """

    daemon_threads = True
    allow_reuse_address = True

    @explains_its_arguments
    def __init__(self, page: Page, *, port: int = 0) -> None:
        try:
            super().__init__((HOST, port), _Handler)
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or error
            raise OutputError(f"could not open port {port} of {HOST}: {reason}. Leave the port out.") from error
        self.token = secrets.token_urlsafe(24)
        self.content = page.html.encode()
        found = _POLICY.search(page.html)
        policy = found[1] if found else "default-src 'none'"
        self.policy = f"{policy}; frame-ancestors 'none'"
        chosen = self.server_address[1]
        self.hosts = frozenset({f"{HOST}:{chosen}", f"localhost:{chosen}"})
        fragment = f"#{page.address}" if page.address else ""
        self.url = f"http://{HOST}:{chosen}/{self.token}/{fragment}"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A connection that breaks is no error of the server."""

    def server_bind(self) -> None:
        """Bind without asking for the name of the machine, which may take seconds."""
        socket_ = self.socket
        if hasattr(socket, "SO_EXCLUSIVEADDRUSE"):
            socket_.setsockopt(socket.SOL_SOCKET, socket.SO_EXCLUSIVEADDRUSE, 1)
        socket_.bind(self.server_address)
        self.server_address = socket_.getsockname()
        self.server_name, self.server_port = HOST, self.server_address[1]


class _Handler(BaseHTTPRequestHandler):
    timeout = _SECONDS
    error_message_format = "%(code)d %(message)s\n"
    error_content_type = "text/plain; charset=utf-8"

    def __getattr__(self, name: str) -> Any:
        # the base class looks for a method do_GET, do_POST, ... by the word that came
        if name.removeprefix("do_") in _METHODS:
            return self._answer
        raise AttributeError(name)

    @property
    def _page_server(self) -> PageServer:
        server = self.server
        assert isinstance(server, PageServer)
        return server

    def _may_see(self) -> bool:
        hosts = self.headers.get_all("Host") or []
        path = self.path.partition("?")[0]
        wanted = f"/{self._page_server.token}/"
        # compared in a time that does not depend on the place of the first wrong letter
        knows = hmac.compare_digest(path.encode("utf-8", "replace"), wanted.encode())
        return knows and len(hosts) == 1 and hosts[0].lower() in self._page_server.hosts

    def _answer(self) -> None:
        if not self._may_see():
            self.send_error(HTTPStatus.FORBIDDEN)
            return
        if self.command not in ("GET", "HEAD"):
            self.send_error(HTTPStatus.METHOD_NOT_ALLOWED)
            return
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.send_header("Content-Length", str(len(self._page_server.content)))
        self.end_headers()
        if self.command == "GET":
            self.wfile.write(self._page_server.content)

    def end_headers(self) -> None:
        for name, value in (
            ("Content-Security-Policy", self._page_server.policy),
            ("Cache-Control", "no-store"),
            ("Referrer-Policy", "no-referrer"),
            ("X-Content-Type-Options", "nosniff"),
            ("X-Frame-Options", "DENY"),
            ("Cross-Origin-Opener-Policy", "same-origin"),
            ("Cross-Origin-Resource-Policy", "same-origin"),
        ):
            self.send_header(name, value)
        super().end_headers()

    def version_string(self) -> str:
        return "liepoisson"

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing is said of requests."""


@explains_its_arguments
def serve(page: Page, *, port: int = 0) -> PageServer:
    """A server of one page, which answers once its `serve_forever` runs; `server_close` ends it.

    Example:
        >>> with lp.laboratory.serve(lp.laboratory.page_of_tops()) as server:
        ...     address = server.url  # now server.serve_forever() would answer until Ctrl-C
        >>> address.count("/"), len(address.split("/")[3])  # the path is a random token
        (4, 32)

    Raises:
        ParameterError: the port is no whole number from 0 to 65,535.
        OutputError: the port is taken, or not to be had.
    """
    return PageServer(page, port=as_count(port, "port", least=0, most=65_535, hint="0 takes a free one"))

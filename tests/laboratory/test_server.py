"""The server of the laboratory: one page for who has the token, and nothing for anybody else."""

import http.client
import socket
import threading

import pytest

from liepoisson.errors import OutputError, ParameterError
from liepoisson.laboratory import Page, serve

PAGE = Page(
    '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'"><p>the page ε</p>', "v=1&t=0", "a page"
)


@pytest.fixture
def server():
    with serve(PAGE) as running:
        thread = threading.Thread(target=running.serve_forever, kwargs={"poll_interval": 0.02})
        thread.start()
        yield running
        running.shutdown()
        thread.join(timeout=10)
        assert not thread.is_alive()


def ask(server, path=None, method="GET", host=None):
    """Status, headers and body."""
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=10)
    path = f"/{server.token}/" if path is None else path
    headers = {} if host is None else {"Host": host}
    connection.request(method, path, headers=headers)
    answer = connection.getresponse()
    body = answer.read()
    connection.close()
    return answer.status, dict(answer.getheaders()), body


def raw(server, text):
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=10) as connection:
        connection.sendall(text)
        connection.shutdown(socket.SHUT_WR)
        answer = b""
        while part := connection.recv(65536):
            answer += part
    return answer


def test_the_page_is_served_whole(server):
    status, headers, body = ask(server)
    assert (status, body.decode()) == (200, PAGE.html)
    assert headers["Content-Type"] == "text/html; charset=utf-8"
    assert ask(server, f"/{server.token}/?still=0")[0] == 200
    assert server.url == f"http://127.0.0.1:{server.server_port}/{server.token}/#v=1&t=0"
    assert server.server_address[0] == "127.0.0.1"


def test_every_answer_has_strict_headers(server):
    for path in (None, "/"):
        _, headers, _ = ask(server, path)
        assert headers["Content-Security-Policy"] == "default-src 'none'; frame-ancestors 'none'"
        assert headers["Cache-Control"] == "no-store"
        assert headers["Referrer-Policy"] == "no-referrer"
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert headers["X-Frame-Options"] == "DENY"
        assert "Python" not in headers["Server"]


@pytest.mark.parametrize(
    "path",
    ["/", "/favicon.ico", "/wrong/", "/{token}", "/{token}/x", "/{token}/../", "/%2e%2e/{token}/",
     "/{token}/%2e%2e/%2e%2e/etc/passwd", "/../../etc/passwd", "/{token}é/", "/{short}/", "?{token}"],
)  # fmt: skip
def test_another_path_is_refused(server, path):
    line = path.format(token=server.token, short=server.token[:-1])
    answer = raw(server, f"GET {line} HTTP/1.1\r\nHost: 127.0.0.1:{server.server_port}\r\n\r\n".encode())
    assert answer.split(b"\r\n", 1)[0].split()[1] == b"403"
    assert b"the page" not in answer


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1", "127.0.0.1:1", "localhost.evil.example:{port}", ""])
def test_another_host_is_refused(server, host):
    status, _, body = ask(server, host=host.format(port=server.server_port))
    assert status == 403
    assert b"the page" not in body


def test_localhost_is_this_machine_and_no_or_two_hosts_are_refused(server):
    assert ask(server, host=f"localhost:{server.server_port}")[0] == 200
    line = f"GET /{server.token}/ HTTP/1.1\r\n"
    host = f"Host: 127.0.0.1:{server.server_port}\r\n"
    assert b" 403 " in raw(server, f"{line}\r\n".encode())
    assert b" 403 " in raw(server, f"{line}{host}Host: evil.example\r\n\r\n".encode())
    assert b" 200 " in raw(server, f"{line}{host}\r\n".encode())


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE"])
def test_other_methods_are_refused(server, method):
    assert ask(server, method=method)[0] == 405
    assert ask(server, "/", method=method)[0] == 403


def test_a_head_has_no_body_and_an_unknown_method_no_page(server):
    status, headers, body = ask(server, method="HEAD")
    assert (status, body, int(headers["Content-Length"])) == (200, b"", len(PAGE.html.encode()))
    assert ask(server, method="BREW")[0] == 501


def test_noise_is_answered_or_dropped_and_the_server_goes_on(server, capsys):
    for noise in (b"\x00\xff\n\n", b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", b"G" * 70_000 + b"\r\n\r\n", b""):
        assert b"the page" not in raw(server, noise)
    assert ask(server)[0] == 200
    assert capsys.readouterr() == ("", "")


def test_a_port_that_is_taken_is_refused():
    with serve(PAGE) as server, pytest.raises(OutputError, match="could not open port"):
        serve(PAGE, port=server.server_port)
    with pytest.raises(ParameterError, match="port: wanted a whole number from 0 to 65535"):
        serve(PAGE, port=70_000)

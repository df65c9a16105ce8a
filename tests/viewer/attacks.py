#!/usr/bin/python3
"""Attacks on the server of `retalho view`, one after the other, against the running program.

  tests/viewer/attacks.py PROGRAM [--no-memory-limit]     (a sanitizer takes more memory than the limit)

After each attack the page must still answer and a call of the session must still work; at the end the program must be
alive, its largest memory under 100 MB, and it must end by SIGINT with code 0. The exit code is 1 if anything failed.
"""
import http.client
import json
import signal
import socket
import struct
import subprocess
import sys
import threading
import time

from attacked import Server

LIMIT_MB = 100
attacks = []


def attack(words):
    def note(function):
        attacks.append((words, function))
        return function
    return note


def refused(status, *codes):
    return None if status in codes else f"answered {status}, not {' or '.join(map(str, codes))}"


def get(server, path):
    return server.raw(f"GET {path} HTTP/1.1\r\nHost: {server.host}\r\nX-Retalho-Session: {server.session}\r\n\r\n".encode())


@attack("a path that climbs out: /../../etc/passwd")
def _(s):
    return refused(get(s, "/../../../../etc/passwd"), 404)


@attack("the same, escaped: %2e%2e%2f")
def _(s):
    return refused(get(s, "/%2e%2e%2f%2e%2e%2fetc/passwd"), 404)


@attack("the same, escaped twice, and with backslashes")
def _(s):
    return refused(get(s, "/%252e%252e/etc/passwd"), 404) or refused(get(s, "/..\\..\\etc\\passwd"), 404)


@attack("an absolute path of a file that exists, and file://")
def _(s):
    return refused(get(s, "//etc/passwd"), 404) or refused(get(s, "file:///etc/passwd"), 404, 400, 0)


@attack("a zero byte in the path")
def _(s):
    # libmicrohttpd cuts the address at the byte; what is left is a name of the page's table, or nothing.
    return refused(get(s, "/%00index.html"), 404) or refused(get(s, "/etc/passwd\0/index.html"), 400, 404, 0)


@attack("a path in a call's body, where a file's number belongs")
def _(s):
    return refused(s.call("/api/terrain/at", {"model": "/etc/passwd", "x": 0, "y": 0})[0], 400)


@attack("a Host of another site (DNS rebinding)")
def _(s):
    return refused(s.request("GET", "/", host=f"evil.example:{s.port}")[0], 421)


@attack("a Host without the port, and one with another port")
def _(s):
    return refused(s.request("GET", "/", host="127.0.0.1")[0], 421) or refused(
        s.request("GET", "/", host=f"127.0.0.1:{s.port - 1}")[0], 421)


@attack("no Host, and two of them")
def _(s):
    return refused(s.raw(b"GET / HTTP/1.1\r\n\r\n"), 400, 421, 0) or refused(
        s.raw(f"GET / HTTP/1.1\r\nHost: {s.host}\r\nHost: evil.example\r\n\r\n".encode()), 400, 421, 0)


@attack("a POST from another site, with the secret")
def _(s):
    return refused(s.call("/api/terrain/files", {}, headers={"Origin": "https://evil.example"})[0], 403)


@attack("a POST from another port of this machine, and from Origin null")
def _(s):
    return refused(s.call("/api/terrain/files", {}, headers={"Origin": f"http://127.0.0.1:{s.port + 1}"})[0],
                   403) or refused(s.call("/api/terrain/files", {}, headers={"Origin": "null"})[0], 403)


@attack("a cross-site request as the browser marks it")
def _(s):
    return refused(s.call("/api/terrain/files", {}, headers={"Sec-Fetch-Site": "cross-site"})[0], 403)


@attack("a form of another site (a simple request: no preflight)")
def _(s):
    return refused(s.call("/api/terrain/files", "a=b", session=False,
                          headers={"Content-Type": "text/plain"})[0], 403) or refused(
        s.call("/api/terrain/files", "{}", headers={"Content-Type": "text/plain"})[0], 415)


@attack("no session, a wrong one, a longer one, and the address's token instead of it")
def _(s):
    for secret in ("", "A" * 32, s.session + "A", s.session[:-1], s.token):
        status = s.call("/api/terrain/files", {}, session=False, headers={"X-Retalho-Session": secret})[0]
        if status != 403:
            return f"secret {secret!r}: answered {status}"
    return refused(s.call("/api/terrain/files", {}, session=False)[0], 403)


@attack("the secret in the address instead of the header")
def _(s):
    return refused(s.call(f"/api/terrain/files?session={s.session}", {}, session=False)[0], 403)


@attack("the printed address used a second time, and tokens that were never printed")
def _(s):
    for token in (s.token, s.session, "", "A" * 32, s.token * 100):
        status, words, _ = s.exchange(token)
        if status != 403 or s.session.encode() in words:
            return f"token {token[:40]!r}: answered {status}"
    return None


def new_token(s):
    return json.loads(s.call("/api/session/token", {})[1])["token"]


@attack("a new tab's token asked for without the session, or exchanged from another site")
def _(s):
    problem = refused(s.call("/api/session/token", {}, session=False)[0], 403)
    token = new_token(s)
    for name, value in (("Origin", "https://evil.example"), ("Sec-Fetch-Site", "cross-site"), ("Host", "evil.example"),
                        ("Content-Type", "text/plain")):
        status, words, _ = s.exchange(token, **{name: value})
        if status not in (403, 415, 421) or s.session.encode() in words:
            return f"{name} {value}: answered {status}"
    return problem or refused(s.exchange(token)[0], 200) or refused(s.exchange(token)[0], 403)


@attack("40 who exchange one token at the same moment: one gets in")
def _(s):
    token, codes = new_token(s), []
    threads = [threading.Thread(target=lambda: codes.append(s.exchange(token)[0])) for _ in range(40)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    return None if sorted(codes) == [200] + [403] * 39 else f"answered {sorted(codes)}"


@attack("a thousand tabs that never come: the oldest tokens are dropped")
def _(s):
    first = new_token(s)
    for _ in range(1000):
        last = new_token(s)
    return refused(s.exchange(first)[0], 403) or refused(s.exchange(last)[0], 200)


@attack("other methods: PUT, DELETE, TRACE, CONNECT, OPTIONS, and one of 8,000 letters")
def _(s):
    for method in ("PUT", "DELETE", "TRACE", "OPTIONS", "POST"):
        if s.request(method, "/", body="{}" if method == "POST" else None)[0] != 405:
            return f"{method} / was not refused"
    if s.request("GET", "/api/terrain/files")[0] != 405:
        return "GET of a call was not refused"
    line = b"G" * 8000 + f" / HTTP/1.1\r\nHost: {s.host}\r\n\r\n".encode()
    return refused(s.raw(line), 400, 405, 414, 431, 501, 0) or refused(
        s.raw(f"CONNECT evil.example:80 HTTP/1.1\r\nHost: {s.host}\r\n\r\n".encode()), 400, 404, 405, 0)


@attack("a body that claims 10 GB, and a length that is no number")
def _(s):
    head = f"POST /api/terrain/files HTTP/1.1\r\nHost: {s.host}\r\nX-Retalho-Session: {s.session}\r\nContent-Type: application/json\r\n"
    return refused(s.raw((head + "Content-Length: 10000000000\r\n\r\n{").encode()), 413, 400, 0) or refused(
        s.raw((head + "Content-Length: -5\r\n\r\n").encode()), 400, 413, 0) or refused(
        s.raw((head + "Content-Length: 99999999999999999999999\r\n\r\n").encode()), 400, 413, 0)


@attack("a body of 50 MB that says so")
def _(s):
    try:
        return refused(s.call("/api/terrain/files", b" " * 50_000_000)[0], 413)
    except (ConnectionError, socket.timeout):
        return None  # closed while it was still being sent


@attack("a body of 200 MB in chunks")
def _(s):
    head = f"POST /api/terrain/files HTTP/1.1\r\nHost: {s.host}\r\nX-Retalho-Session: {s.session}\r\nContent-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n"
    chunk = b"10000\r\n" + b" " * 65536 + b"\r\n"
    with s.connect() as c:
        try:
            c.sendall(head.encode())
            for _ in range(3200):
                c.sendall(chunk)
        except (ConnectionError, socket.timeout):
            return None
    return "all of it was taken"


@attack("chunks of broken sizes")
def _(s):
    head = f"POST /api/terrain/files HTTP/1.1\r\nHost: {s.host}\r\nX-Retalho-Session: {s.session}\r\nContent-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n"
    for size in ("zz", "-1", "ffffffffffffffffffff", "7fffffffffffffff"):
        status = s.raw((head + size + "\r\n{}\r\n0\r\n\r\n").encode(), timeout=12)
        if status not in (0, 400, 413):
            return f"size {size}: answered {status}"
    return None


@attack("both a length and chunks (request smuggling)")
def _(s):
    body = f"0\r\n\r\nGET / HTTP/1.1\r\nHost: {s.host}\r\n\r\n"
    head = f"POST /api/terrain/files HTTP/1.1\r\nHost: {s.host}\r\nX-Retalho-Session: {s.session}\r\nContent-Type: application/json\r\nTransfer-Encoding: chunked\r\nContent-Length: {len(body)}\r\n\r\n"
    return refused(s.raw((head + body).encode()), 200, 400, 0)


@attack("100,000 headers")
def _(s):
    return refused(s.raw(f"GET / HTTP/1.1\r\nHost: {s.host}\r\n".encode() +
                         b"".join(b"X-%d: y\r\n" % k for k in range(100_000)) + b"\r\n"), 400, 413, 431, 0)


@attack("one header of 10 MB, and an address of 1 MB")
def _(s):
    return refused(s.raw(f"GET / HTTP/1.1\r\nHost: {s.host}\r\nX: ".encode() + b"a" * 10_000_000 + b"\r\n\r\n"),
                   400, 413, 431, 0) or refused(get(s, "/" + "a" * 1_000_000), 400, 404, 413, 414, 431, 0)


@attack("500 connections that say nothing")
def _(s):
    held = []
    try:
        for _ in range(500):
            try:
                held.append(s.connect(1))
            except OSError:
                break
        return s.answers()
    finally:
        for c in held:
            c.close()


@attack("200 connections that send one byte a second (slow headers)")
def _(s):
    held = []
    try:
        for _ in range(200):
            c = s.connect(1)
            c.sendall(f"GET / HTTP/1.1\r\nHost: {s.host}\r\nX: ".encode())
            held.append(c)
        for _ in range(4):
            for c in held:
                try:
                    c.sendall(b"a")
                except OSError:
                    pass
            problem = s.answers()
            if problem:
                return problem
            time.sleep(1)
    except OSError:
        return s.answers()
    finally:
        for c in held:
            c.close()


@attack("a slow body with the secret is cut off")
def _(s):
    head = f"POST /api/terrain/files HTTP/1.1\r\nHost: {s.host}\r\nX-Retalho-Session: {s.session}\r\nContent-Type: application/json\r\nContent-Length: 1000\r\n\r\n"
    with s.connect(30) as c:
        c.sendall(head.encode())
        begun = time.monotonic()
        try:
            while time.monotonic() - begun < 20:
                c.sendall(b" ")
                time.sleep(0.5)
        except OSError:
            return None
    return "it was still taken after 20 s"


@attack("connections that are reset while the server answers")
def _(s):
    for _ in range(100):
        c = s.connect()
        c.sendall(f"GET /page.js HTTP/1.1\r\nHost: {s.host}\r\n\r\n".encode())
        c.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        c.close()
    return None


@attack("a client that asks for the page and never reads it")
def _(s):
    held = [s.connect() for _ in range(40)]
    for c in held:
        c.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
        c.sendall(f"GET /page.js HTTP/1.1\r\nHost: {s.host}\r\n\r\n".encode() * 20)
    problem = s.answers()
    for c in held:
        c.close()
    return problem


@attack("JSON that is none, or of the wrong kind, or not UTF-8")
def _(s):
    for body in (b"{", b"[]", b"null", b"\"x\"", b"{\"file\": }", b"\xff\xfe", b"\0\0\0\0", b"{\"a\":1}{\"b\":2}"):
        status = s.call("/api/terrain/at", body)[0]
        if status != 400:
            return f"{body!r}: answered {status}"
    return None


@attack("JSON nested 300,000 deep")
def _(s):
    for body in (b"[" * 300_000, b"{\"a\":" * 150_000, b"[" * 300_000 + b"]" * 300_000):
        status = s.call("/api/terrain/at", body)[0]
        if status != 400:
            return f"answered {status}"
    return None


@attack("numbers out of range: 1e999, NaN, -1, 2^63, a text")
def _(s):
    for file in ("1e999", "NaN", "-1", "9223372036854775807", "\"0\"", "0.5", "null", "[0]", "{}"):
        status, words, _ = s.call("/api/terrain/fit", f"{{\"file\": {file}, \"surface\": \"linear\"}}")
        if status != 400 and b"event: failed" not in words:
            return f"file {file}: answered {status}, {words[:200]!r}"
    return None


@attack("calls of the editors with inputs that are wrong in every way")
def _(s):
    side = {"kind": "bezier", "points": [[0, 0, 0], [1, 0, 0]]}
    good = {"patches": [{"sides": [side] * 3}]}
    tries = [("/api/curves/compute", {"document": {"curves": [{"kind": "bezier", "points": [[1e308, 1], [0, -1e308]], "degree": -3}]}}),
             ("/api/curves/compute", {"document": {"curves": [{"kind": "bspline", "degree": 3, "points": [[0, 0]] * 5, "knots": [0, 1]}]}}),
             ("/api/curves/compute", {"document": {"curves": [{"kind": "polyline", "points": [[0, 0]] * 5000}]}}),
             ("/api/curves/compute", {}), ("/api/curves/compute", {"document": []}), ("/api/curves/compute", {"document": "x", "t": 3}),
             ("/api/curves/change", {"document": {"curves": []}, "curve": 0, "what": "split"}),
             ("/api/curves/change", {"document": {"curves": [side]}, "curve": 9, "what": "split", "t": 0.5}),
             ("/api/curves/change", {"document": {"curves": [side]}, "curve": 0, "what": "burn"}),
             ("/api/patches/compute", {"document": good, "divisions": 8, "recovery": "smooth", "colour": "none"}),
             ("/api/patches/compute", {"document": good, "divisions": 1e9, "recovery": "smooth", "colour": "none"}),
             ("/api/patches/at", {"document": {"patches": []}, "divisions": 8, "recovery": "spr", "u": 0, "v": 0}),
             ("/api/tetraquads/load", {"document": {"tetrahedra": [[0, 0, 0, 99]]}}), ("/api/tetraquads/load", {"file": 0}),
             ("/api/tetraquads/load", {"document": {"tetrahedra": [[0, 0, 0, 0]], "step": 0}}),
             ("/api/tetraquads/ray", {"document": {"tetrahedra": [[0, 0, 0, 0]], "everywhere": {"xx": 1, "1": -0.1}}, "origin": [0, 0], "direction": "up"})]
    refused_in_curve = 0
    for path, body in tries:
        status, words, _ = s.call(path, body)
        if status == 200 and path == "/api/curves/compute":
            refused_in_curve += b"error" in words
        elif status != 400 or len(json.loads(words)["error"]["message"]) < 10:
            return f"{path} {str(body)[:80]}: answered {status} {words[:120]!r}"
    return None if refused_in_curve >= 1 else "no curve was refused"


@attack("work that would never end: a tolerance of 0 and an interval of 1e-9")
def _(s):
    status, words, _ = s.fit()
    if status != 200 or b"event: done" not in words:
        return f"the fit failed: {words[-300:]!r}"
    model = json.loads(words.split(b"event: done\ndata: ")[1].split(b"\n")[0])["words"]["model"]
    words = s.call("/api/terrain/contours", {"model": model, "interval": 1e-9})[1]
    return None if b"event: failed" in words else f"answered {words[:200]!r}"


@attack("another's answer: results that were never made, or fetched twice")
def _(s):
    words = s.fit(vertices=60)[1]
    result = json.loads(words.split(b"event: done\ndata: ")[1].split(b"\n")[0])["result"]
    first, second = (s.call("/api/result", {"id": result}) for _ in range(2))
    if b"this answer was fetched already, or has been dropped: ask again" not in second[1]:
        return f"answered {second[1][:200]!r}"
    return refused(first[0], 200) or refused(second[0], 400) or refused(s.call("/api/result", {"id": 999_999})[0], 400)


@attack("300 calls at once")
def _(s):
    codes = []

    def one():
        try:
            codes.append(s.fit(vertices=70 + len(codes) % 3)[0])
        except (OSError, http.client.HTTPException):
            codes.append(0)
    threads = [threading.Thread(target=one) for _ in range(300)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    strange = [c for c in codes if c not in (0, 200, 503)]
    return f"answered {strange[:5]}" if strange else None if 200 in codes else "none was answered"


@attack("a tab that closes in the middle of its work ends it")
def _(s):
    words = json.dumps({"file": 0, "surface": "clough-tocher", "fit": "surface", "vertices": 20000,
                        "triangles": 100000}).encode()
    c = s.connect()
    c.sendall(f"POST /api/terrain/fit HTTP/1.1\r\nHost: {s.host}\r\nX-Retalho-Session: {s.session}\r\nContent-Type: "
              f"application/json\r\nContent-Length: {len(words)}\r\n\r\n".encode() + words)
    c.recv(100)  # the first progress: it is in work
    c.close()
    begun = time.monotonic()
    status, answer, _ = s.fit(vertices=80)  # waits for its turn behind the other
    seconds = time.monotonic() - begun
    if status != 200 or b"event: done" not in answer:
        return f"the next call failed: {answer[-300:]!r}"
    return None if seconds < 3 else f"the next call had to wait {seconds:.1f} s"


def main():
    server = Server(sys.argv[1])
    failed = []
    problem = server.answers()
    if problem:
        failed.append(f"before any attack: {problem}")
    for number, (words, function) in enumerate(attacks, 1):
        begun = time.monotonic()
        try:
            problem = function(server)
        except Exception as error:  # an attack may end in any way; a test that dies has found something
            problem = f"{type(error).__name__}: {error}"
        try:
            problem = problem or server.answers()
        except Exception as error:
            problem = problem or f"the page does not answer any more: {type(error).__name__}: {error}"
        if server.process.poll() is not None:
            failed.append(words)
            print(f"{number:2} FAILED {words}: the program ended with code {server.process.returncode}")
            break
        if problem:
            failed.append(words)
        print(f"{number:2} {'FAILED' if problem else 'ok'} {words}" + (f": {problem}" if problem else "") +
              f" ({time.monotonic() - begun:.1f} s, {server.memory_mb():.0f} MB)", flush=True)
    if server.process.poll() is None:
        memory = server.memory_mb()
        if memory > LIMIT_MB and "--no-memory-limit" not in sys.argv:
            failed.append(f"largest memory {memory:.0f} MB, over {LIMIT_MB} MB")
        server.process.send_signal(signal.SIGINT)
        try:
            code = server.process.wait(10)
            if code != 0:
                failed.append(f"SIGINT ended it with code {code}")
        except subprocess.TimeoutExpired:
            server.process.kill()
            failed.append("SIGINT did not end it within 10 s")
        print(f"{len(attacks)} attacks, {len(failed)} failed, largest memory {memory:.1f} MB")
    for words in failed:
        print("FAILED", words)
    if len(attacks) < 28:
        sys.exit("attacks: fewer than 28")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()

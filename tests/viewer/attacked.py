"""The server of `retalho view` as attacks.py sees it: started, asked, and measured."""
import http.client
import json
import socket
import subprocess
import sys
import time


class Server:
    def __init__(self, program):
        self.process = subprocess.Popen([program, "view", "--no-browser", "--json", "--quiet", "--threads", "2"],
                                        stdout=subprocess.PIPE)
        text = b""
        while b"}" not in text:
            line = self.process.stdout.readline()
            if not line:
                sys.exit(f"attacks: the program ended with code {self.process.wait()}")
            text += line
        address = json.loads(text)["address"]
        self.port = int(address.split(":")[2].split("/")[0])
        self.token = address.split("#token=")[1]
        self.host = f"127.0.0.1:{self.port}"
        status, words, _ = self.exchange(self.token)
        if status != 200:
            sys.exit(f"attacks: the exchange of the token answered {status}: {words!r}")
        self.session = json.loads(words)["session"]

    def connect(self, timeout=5):
        return socket.create_connection(("127.0.0.1", self.port), timeout)

    def raw(self, data, timeout=5, read=True):
        """Sends bytes; the status line's number, or 0 when the server only closed the connection."""
        with self.connect(timeout) as s:
            try:
                s.sendall(data)
                answer = b""
                while read and b"\r\n" not in answer:
                    more = s.recv(4096)
                    if not more:
                        break
                    answer += more
            except (ConnectionError, socket.timeout):
                return 0
        return int(answer.split()[1]) if answer.startswith(b"HTTP/1.") else 0

    def request(self, method, path, headers=None, body=None, session=True, host=None, timeout=30):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=timeout)
        sent = {"Host": host or self.host, **(headers or {})}
        if method == "POST":
            sent.setdefault("Content-Type", "application/json")
        if session:
            sent.setdefault("X-Retalho-Session", self.session)
        try:
            connection.request(method, path, body=body, headers=sent)
            response = connection.getresponse()
            return response.status, response.read(), dict(response.getheaders())
        finally:
            connection.close()

    def call(self, path, body, **more):
        return self.request("POST", path, body=body if isinstance(body, (bytes, str)) else json.dumps(body), **more)

    def exchange(self, token, **headers):
        return self.request("POST", "/api/session", body="{}", session=False, headers={"X-Retalho-Token": token, **headers})

    def fit(self, **more):
        words = {"file": 0, "surface": "linear", "fit": "interpolate", "vertices": 50, "triangles": 5000, **more}
        return self.call("/api/terrain/fit", words)

    def memory_mb(self):
        with open(f"/proc/{self.process.pid}/status") as status:
            return next(int(line.split()[1]) for line in status if line.startswith("VmHWM")) / 1024

    def answers(self):
        """The page and a call, each within five seconds."""
        begun = time.monotonic()
        page, _, headers = self.request("GET", "/", session=False, timeout=5)
        call, words, _ = self.call("/api/terrain/files", {}, timeout=5)
        if page != 200 or call != 200 or b"Example" not in words:
            return f"the page answers {page}, a call {call}"
        if not headers.get("Content-Security-Policy", "").startswith("default-src 'self'"):
            return "the page has no content security policy"
        if time.monotonic() - begun > 5:
            return "the page took over 5 s"
        return None

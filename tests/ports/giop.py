"""A small ORB that shares no line with the ORB of the product: GIOP 1.0 and 1.2 over TCP, both byte orders, fragments.

Enough for ports of another make. Any thread; a thread for each connection that comes in.
"""

import contextlib
import itertools
import socket
import struct
import threading

TK_STRING, TK_OBJREF, TK_ALIAS = 18, 14, 21
NUMBERS = {2: 'h', 3: 'i', 4: 'H', 5: 'I', 6: 'f', 7: 'd', 8: '?', 10: 'B', 23: 'q', 24: 'Q'}  # type code kinds


class Out:
    """Encodes; `origin` octets that are not part of the data count for the alignment."""

    def __init__(self, order='>', start=b''):
        self.order = order
        self.data = bytearray(start)

    def align(self, size):
        self.data += bytes(-len(self.data) % size)

    def number(self, code, value):
        packed = struct.pack(self.order + code, value)
        self.align(len(packed))
        self.data += packed

    def octet(self, value):
        self.number('B', value)

    def ulong(self, value):
        self.number('I', value)

    def octets(self, value):
        self.ulong(len(value))
        self.data += value

    def string(self, text):
        self.octets(text.encode('latin-1') + b'\0')

    def sequence(self, values, write):
        self.ulong(len(values))
        for value in values:
            write(value)

    def ior(self, ior):
        ior = ior or Ior('', [])
        self.string(ior.type_id)
        self.ulong(len(ior.profiles))
        for tag, body in ior.profiles:
            self.ulong(tag)
            self.octets(body)

    def encapsulation(self, fill):
        inner = Out(self.order)
        inner.octet(1 if self.order == '<' else 0)
        fill(inner)
        self.octets(inner.data)

    def any(self, value):
        if isinstance(value, str):
            self.ulong(TK_STRING)
            self.ulong(0)
            self.string(value)
        elif isinstance(value, Ior):
            self.ulong(TK_OBJREF)
            self.encapsulation(lambda inner: (inner.string(value.type_id), inner.string('Object')))
            self.ior(value)
        elif isinstance(value, Alias):
            self.ulong(TK_ALIAS)
            self.encapsulation(lambda inner: (inner.string('IDL:test/Text:1.0'), inner.string('Text'), inner.ulong(TK_STRING),
                                              inner.ulong(0)))
            self.string(value.text)
        else:
            kind, number = value
            self.ulong(kind)
            self.number(NUMBERS[kind], number)


class In:
    def __init__(self, data, order, position=0):
        self.data, self.order, self.position = data, order, position

    def number(self, code):
        size = struct.calcsize('=' + code)
        self.position += -self.position % size
        value, = struct.unpack_from(self.order + code, self.data, self.position)
        self.position += size
        return value

    def octet(self):
        return self.number('B')

    def ulong(self):
        return self.number('I')

    def octets(self):
        size = self.ulong()
        if self.position + size > len(self.data):
            raise ValueError('octets beyond the end')
        value = bytes(self.data[self.position:self.position + size])
        self.position += size
        return value

    def string(self):
        return self.octets()[:-1].decode('latin-1')

    def sequence(self, read):
        return [read() for _ in range(self.ulong())]

    def ior(self):
        type_id = self.string()
        ior = Ior(type_id, self.sequence(lambda: (self.ulong(), self.octets())))
        return ior if ior.profiles else None

    def encapsulation(self):
        data = self.octets()
        return In(data, '<' if data[0] & 1 else '>', 1)

    def any(self):
        return self.value(*self.type())

    def type(self):
        kind = self.ulong()
        if kind == TK_STRING:
            self.ulong()
        if kind in (TK_OBJREF, TK_ALIAS):
            inner = self.encapsulation()
            inner.string()
            inner.string()
            if kind == TK_ALIAS:
                return inner.type()
        return (kind,)

    def value(self, kind):
        if kind in (0, 1):  # null, void
            return None
        if kind == TK_STRING:
            return self.string()
        if kind == TK_OBJREF:
            return self.ior()
        if kind in NUMBERS:
            return kind, self.number(NUMBERS[kind])
        raise ValueError('an any of kind %d' % kind)


class Alias:
    """A string whose type has a name."""

    def __init__(self, text):
        self.text = text


class Ior:
    def __init__(self, type_id, profiles):
        self.type_id, self.profiles = type_id, profiles

    @staticmethod
    def make(type_id, host, port, key, version):
        body = Out('>')
        body.octet(0)
        body.octet(1)
        body.octet(version)
        body.string(host)
        body.number('H', port)
        body.octets(key)
        if version:
            body.ulong(0)  # no components
        return Ior(type_id, [(0, bytes(body.data))])

    @staticmethod
    def parse(text):
        data = bytes.fromhex(text.strip()[4:])
        return In(data, '<' if data[0] & 1 else '>', 1).ior()

    def __str__(self):
        out = Out('<')
        out.octet(1)
        out.ior(self)
        return 'IOR:' + out.data.hex()

    def address(self):
        """(host, port, key) of the first profile of IIOP."""
        for tag, data in self.profiles:
            if tag == 0:
                body = In(data, '<' if data[0] & 1 else '>', 1)
                body.octet(), body.octet()
                return body.string(), body.number('H'), body.octets()
        raise ValueError('no profile of IIOP')

    def key(self):
        return self.address()[2]


class SystemException(Exception):
    pass


def receive(stream, size):
    data = b''
    while len(data) < size:
        piece = stream.recv(size - len(data))
        if not piece:
            raise EOFError
        data += piece
    return data


def receive_message(stream):
    """(kind, version, data with the header, order), fragments put together."""
    whole = None
    while True:
        header = receive(stream, 12)
        if header[:4] != b'GIOP':
            raise ValueError('not GIOP')
        order = '<' if header[6] & 1 else '>'
        size, = struct.unpack(order + 'I', header[8:])
        body = receive(stream, size)
        if whole is None:
            whole, kind, version = bytearray(header + body), header[7], header[5]
        else:
            whole += body[4:] if version >= 2 else body
        if not header[6] & 2:
            return kind, version, bytes(whole), order


def send_message(stream, kind, version, order, out):
    out.data[0:12] = b'GIOP' + bytes([1, version, 1 if order == '<' else 0, kind]) + struct.pack(order + 'I', len(out.data) - 12)
    stream.sendall(out.data)


class Orb:
    """Serves objects: key -> (ids of its interfaces, call(operation, In, Out))."""

    def __init__(self, version=2, order='>'):
        self.version, self.order = version, order
        self.objects = {}
        self.numbers = itertools.count(1)
        self.close_after_request = 0  # so many requests are dropped together with their connection
        self.kept = None  # a threading.local(): calls of a thread to one address share a connection; None: each has its own
        self.listener = socket.create_server(('127.0.0.1', 0))
        self.streams = []
        threading.Thread(target=self.accept, args=(self.listener,), daemon=True).start()

    def add(self, interface, call, bases=()):
        key = b'foreign\x00%d' % next(self.numbers)
        self.objects[key] = ({interface, 'IDL:omg.org/CORBA/Object:1.0', *bases}, call)
        return Ior.make(interface, '127.0.0.1', self.listener.getsockname()[1], key, self.version)

    def stop(self):
        """As if the process had died."""
        if self.listener is None:
            return
        self.listener.shutdown(socket.SHUT_RDWR)
        self.listener.close()
        self.listener = None
        for stream in self.streams:
            try:
                stream.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass  # the other side was faster

    def accept(self, listener):
        while True:
            try:
                stream, _ = listener.accept()
            except OSError:
                return
            stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self.streams.append(stream)
            threading.Thread(target=self.serve, args=(stream,), daemon=True).start()

    def serve(self, stream):
        with stream:
            try:
                while self.answer(stream):
                    pass
            except (OSError, EOFError):
                pass  # the caller has gone

    def answer(self, stream):
        kind, version, data, order = receive_message(stream)
        message = In(data, order, 12)
        if kind == 5:
            return False
        if kind not in (0, 3):
            return True
        if version < 2 and kind == 0:
            self.skip_contexts(message)
        number = message.ulong()
        if version < 2:
            expects_answer = kind == 3 or message.octet()
            key = message.octets() if kind == 3 or version == 0 else (message.octet(), message.octet(), message.octet(), message.octets())[3]
        else:
            expects_answer = kind == 3 or (message.octet(), message.octet(), message.octet(), message.octet())[0] & 1
            if message.number('H') != 0:
                raise ValueError('an address of another kind')
            key = message.octets()
        reply = Out(self.order, bytes(12))
        known = self.objects.get(key)
        if kind == 3:
            reply.ulong(number)
            reply.ulong(1 if known else 0)
            send_message(stream, 4, version, self.order, reply)
            return True
        operation = message.string()
        if version < 2:
            message.octets()
        else:
            self.skip_contexts(message)
            message.position += -message.position % 8
        if self.close_after_request and not operation.startswith('_'):
            self.close_after_request -= 1
            return False
        result = Out(self.order, bytes(16))  # aligned like the body of a reply
        failed = self.call(known, operation, message, result)
        if not expects_answer:
            return True
        if version < 2:
            reply.ulong(0)
            reply.ulong(number)
            reply.ulong(2 if failed else 0)
        else:
            reply.ulong(number)
            reply.ulong(2 if failed else 0)
            reply.ulong(0)
        if version < 2:  # the header has 24 octets: the body starts at a multiple of 8 as well
            reply.data += result.data[16:]
        elif len(result.data) > 16:
            reply.align(8)
            reply.data += result.data[16:]
        send_message(stream, 1, version, self.order, reply)
        return True

    @staticmethod
    def skip_contexts(message):
        message.sequence(lambda: (message.ulong(), message.octets()))

    def call(self, known, operation, message, result):
        try:
            if known is None:
                raise SystemException('OBJECT_NOT_EXIST')
            interfaces, call = known
            if operation == '_is_a':
                result.octet(message.string() in interfaces)
            elif operation == '_non_existent':
                result.octet(0)
            else:
                call(operation, message, result)
            return False
        except SystemException as problem:
            del result.data[16:]
            result.string('IDL:omg.org/CORBA/%s:1.0' % problem)
            result.ulong(0)
            result.ulong(1)
            return True

    @contextlib.contextmanager
    def connection(self, host, port, timeout):
        streams = {} if self.kept is None else self.kept.__dict__
        stream = streams.pop((host, port), None)
        if stream is None:
            stream = socket.create_connection((host, port), timeout)
            stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        try:
            yield stream
        except BaseException:
            stream.close()
            raise
        if self.kept is None:
            stream.close()
        else:
            streams[host, port] = stream

    def invoke(self, target, operation, write=lambda out: None, timeout=60.0):
        """The body of the answer. Raises SystemException with the name of the exception."""
        host, port, key = target.address()
        with self.connection(host, port, timeout) as stream:
            request = Out(self.order, bytes(12))
            if self.version < 2:
                request.ulong(0)
                request.ulong(1)
                request.octet(1)
                request.octets(key)
                request.string(operation)
                request.ulong(0)
            else:
                request.ulong(1)
                request.data += bytes([3, 0, 0, 0])
                request.number('H', 0)
                request.octets(key)
                request.string(operation)
                request.ulong(0)
                body = Out(self.order, bytes(16))
                write(body)
                if len(body.data) > 16:
                    request.align(8)
                    request.data += body.data[16:]
            if self.version < 2:
                write(request)
            send_message(stream, 0, self.version, self.order, request)
            kind, version, data, order = receive_message(stream)
            if kind != 1:
                raise SystemException('answer of kind %d' % kind)
            answer = In(data, order, 12)
            if version < 2:
                self.skip_contexts(answer)
                answer.ulong()
                status = answer.ulong()
            else:
                answer.ulong()
                status = answer.ulong()
                self.skip_contexts(answer)
                answer.position += -answer.position % 8
            if status == 3:
                return self.invoke(answer.ior(), operation, write, timeout)
            if status != 0:
                raise SystemException(answer.string())
            return answer

#!/usr/bin/env python3
"""Ports of another make against ours, in two processes: an ORB of its own (giop.py) and ports that behave as those of OpenRTM-aist 1.2.

    foreign_test.py PORTS_PEER [unittest arguments]

Our side is ports_peer --echo, whose OutPort sends whatever its InPort receives.
"""

import ctypes
import os
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
import unittest
import uuid

from giop import Alias, In, Ior, Orb, Out, SystemException

OK, ERROR, BAD_PARAMETER, UNSUPPORTED, _, PRECONDITION_NOT_MET = range(6)
PORT_OK, PORT_ERROR, BUFFER_FULL, BUFFER_EMPTY, BUFFER_TIMEOUT = range(5)
PORT = 'IDL:omg.org/RTC/PortService:1.0'
IN_CDR, OUT_CDR = 'IDL:OpenRTM/InPortCdr:1.0', 'IDL:OpenRTM/OutPortCdr:1.0'
NAMES = {'corba_cdr': (IN_CDR, OUT_CDR, 'put', 'get'),
         'data_service': ('IDL:omg.org/RTC/DataPushService:1.0', 'IDL:omg.org/RTC/DataPullService:1.0', 'push', 'pull')}
WATCHDOG = 60  # [s]


def eventually(condition):
    end = time.monotonic() + WATCHDOG
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.002)
    return False


def die_with_parent():
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)


class Profile:
    """A ConnectorProfile; properties are a list, as a name may be there twice."""

    def __init__(self, ports, properties=(), name='foreign', connector_id=''):
        self.name, self.id, self.ports = name, connector_id, list(ports)
        self.properties = [('dataport.interface_type', 'corba_cdr'), ('dataport.dataflow_type', 'push')]
        for key, value in properties:
            self.set('dataport.' + key, value)

    def get(self, key):
        for name, value in self.properties:
            if name == key:
                return value
        return None

    def set(self, key, value):
        self.properties = [entry for entry in self.properties if entry[0] != key] + [(key, value)]

    def write(self, out):
        out.string(self.name)
        out.string(self.id)
        out.sequence(self.ports, out.ior)
        out.sequence(self.properties, lambda entry: (out.string(entry[0]), out.any(entry[1])))

    def read(self, data):
        self.name, self.id = data.string(), data.string()
        self.ports = data.sequence(data.ior)
        self.properties = data.sequence(lambda: (data.string(), data.any()))
        return self


class Connected:
    """The calls to a PortService of anybody."""

    def __init__(self, orb, ior):
        self.orb, self.ior = orb, ior

    def change(self, operation, profile):
        answer = self.orb.invoke(self.ior, operation, profile.write)
        code = answer.ulong()
        profile.read(answer)
        return code

    def connect(self, profile):
        return self.change('connect', profile)

    def notify_connect(self, profile):
        return self.change('notify_connect', profile)

    def by_id(self, operation, connector_id):
        return self.orb.invoke(self.ior, operation, lambda out: out.string(connector_id)).ulong()

    def disconnect(self, connector_id):
        return self.by_id('disconnect', connector_id)

    def disconnect_all(self):
        return self.orb.invoke(self.ior, 'disconnect_all').ulong()

    def connector_profiles(self):
        answer = self.orb.invoke(self.ior, 'get_connector_profiles')
        return answer.sequence(lambda: Profile([]).read(answer))


class ForeignPort:
    """As OpenRTM-aist 1.2 does it: the profile is kept whatever happens, keys are added at the end, the chain is nested calls."""

    def __init__(self, orb, side):
        self.orb, self.side = orb, side
        self.profiles = []
        self.received, self.refused = [], []
        self.answers = PORT_OK
        self.kept = None  # what a pull OutPort hands out
        self.targets = {}
        self.ior = orb.add(PORT, self.call)

    def call(self, operation, data, out):
        if operation in ('connect', 'notify_connect'):
            profile = Profile([]).read(data)
            code = getattr(self, operation)(profile)
            out.ulong(code)
            profile.write(out)
        elif operation in ('disconnect', 'notify_disconnect'):
            out.ulong(getattr(self, operation)(data.string()))
        elif operation == 'get_connector_profiles':
            out.sequence(self.profiles, lambda profile: profile.write(out))
        else:
            raise SystemException('NO_IMPLEMENT')

    def connect(self, profile):
        if profile.get('dataport.serializer.cdr.endian') is None:
            profile.properties.append(('dataport.serializer.cdr.endian', 'little,big'))
        if not profile.id:
            profile.id = str(uuid.uuid4())
        elif self.find(profile.id):
            return PRECONDITION_NOT_MET
        code = Connected(self.orb, profile.ports[0]).notify_connect(profile)
        if code != OK:
            self.disconnect(profile.id)
        return code

    def find(self, connector_id):
        return next((profile for profile in self.profiles if profile.id == connector_id), None)

    def place(self, profile):
        return [port.key() for port in profile.ports].index(self.ior.key())

    @staticmethod
    def interface(profile):
        """What it does not know it mistakes for corba_cdr."""
        given = profile.get('dataport.interface_type')
        return given if given in NAMES else 'corba_cdr'

    def notify_connect(self, profile):
        is_push = profile.get('dataport.dataflow_type').strip().lower() == 'push'
        if is_push == (self.side == 'in'):
            interface = self.interface(profile)
            name = 'dataport.%s.%sport' % (interface, self.side)
            ior = self.orb.add(NAMES[interface][0 if self.side == 'in' else 1], self.serve)
            profile.properties += [(name + '_ior', str(ior)), (name + '_ref', ior)]
        codes = [OK]
        following = profile.ports[self.place(profile) + 1:]
        if following:
            codes.append(Connected(self.orb, following[0]).notify_connect(profile))
        if is_push != (self.side == 'in'):
            codes.append(self.subscribe(profile))
        if self.find(profile.id):
            self.profiles.remove(self.find(profile.id))
        self.profiles.append(profile)
        return next((code for code in codes if code != OK), OK)

    def subscribe(self, profile):
        # The last one of a name counts, as here references of old are in front.
        interface = self.interface(profile)
        key = 'dataport.%s.%sport_ior' % (interface, 'in' if self.side == 'out' else 'out')
        texts = [value for name, value in profile.properties if name == key]
        if not texts:
            return ERROR
        self.targets[profile.id] = Ior.parse(texts[-1]), NAMES[interface]
        return OK

    def disconnect(self, connector_id):
        profile = self.find(connector_id)
        if profile is None:
            return BAD_PARAMETER
        for port in profile.ports:
            try:
                return Connected(self.orb, port).by_id('notify_disconnect', connector_id)
            except (OSError, SystemException):
                pass  # the next one takes the lead
        return ERROR

    def notify_disconnect(self, connector_id):
        profile = self.find(connector_id)
        if profile is None:
            return BAD_PARAMETER
        for port in profile.ports[self.place(profile) + 1:]:
            try:
                Connected(self.orb, port).by_id('notify_disconnect', connector_id)
                break
            except (OSError, SystemException):
                pass
        self.profiles.remove(profile)
        self.targets.pop(connector_id, None)
        return OK

    def serve(self, operation, data, out):
        if operation in ('put', 'push'):
            (self.received if self.answers == PORT_OK else self.refused).append(data.octets())
            out.ulong(self.answers)
        elif operation in ('get', 'pull'):
            out.ulong(BUFFER_EMPTY if self.kept is None else PORT_OK)
            out.octets(self.kept or b'')
        else:
            raise SystemException('BAD_OPERATION')

    def write(self, octets):
        """Push. The status that the receiver gives."""
        (target, names), = self.targets.values()
        return self.orb.invoke(target, names[2], lambda out: out.octets(octets)).ulong()

    def fetch(self):
        """Pull: (status, octets)."""
        (target, names), = self.targets.values()
        answer = self.orb.invoke(target, names[3])
        return answer.ulong(), answer.octets()


def sample(payload, order='<', seconds=7):
    return struct.pack(order + 'III', seconds, 0, len(payload)) + payload


class Foreign(unittest.TestCase):
    version, order = 2, '>'

    def setUp(self):
        self.process = subprocess.Popen([peer_program, '--echo'], stdout=subprocess.PIPE, text=True, preexec_fn=die_with_parent)
        self.references = {}
        for line in self.process.stdout:
            if line == 'ready\n':
                break
            name, text = line.split()
            self.references[name] = text
        self.orb = Orb(self.version, self.order)
        self.our_in = Connected(self.orb, Ior.parse(self.references['in']))
        self.our_out = Connected(self.orb, Ior.parse(self.references['out']))
        self.out = ForeignPort(self.orb, 'out')
        self.into = ForeignPort(self.orb, 'in')

    def tearDown(self):
        self.orb.stop()
        self.process.terminate()
        self.process.stdout.close()
        self.assertEqual(self.process.wait(WATCHDOG), 0)

    def expect_nothing_left(self):
        for port in (self.our_in, self.our_out):
            self.assertEqual(port.connector_profiles(), [])
        self.assertEqual(self.out.profiles + self.into.profiles, [])

    def echo(self, payload, order='<'):
        """From the foreign OutPort through our process into the foreign InPort."""
        before = len(self.into.received)
        self.assertEqual(self.out.write(sample(payload, order)), PORT_OK)
        self.assertTrue(eventually(lambda: len(self.into.received) > before))
        return self.into.received[-1]

    def connect_both(self, properties=()):
        forth = Profile([self.out.ior, self.our_in.ior], properties)
        back = Profile([self.our_out.ior, self.into.ior], properties)
        self.assertEqual(self.out.connect(forth), OK)
        self.assertEqual(self.our_out.connect(back), OK)
        return forth, back

    def test_samples_go_there_and_back(self):
        forth, back = self.connect_both()
        self.assertTrue(forth.get('dataport.corba_cdr.inport_ior').startswith('IOR:'))
        self.assertEqual(forth.get('dataport.corba_cdr.inport_ref').type_id, IN_CDR)
        self.assertEqual(back.get('dataport.serializer.cdr.endian'), 'little,big')
        self.assertEqual(len(back.id), 36)
        for size in (0, 1, 100, 5000, 1 << 20):
            payload = bytes(i * 7 & 255 for i in range(size))
            self.assertEqual(self.echo(payload), sample(payload))
        self.assertEqual(self.out.disconnect(forth.id), OK)
        self.assertEqual(self.our_out.disconnect(back.id), OK)
        self.expect_nothing_left()

    def test_anybody_may_connect_and_any_port_may_be_first(self):
        for dataflow in ('push', 'pull'):
            for ports in ([self.out.ior, self.our_in.ior], [self.our_in.ior, self.out.ior]):
                # The foreign port itself, a tool that asks the foreign port, one that asks ours.
                for connector in (self.out, Connected(self.orb, self.out.ior), self.our_in):
                    profile = Profile(ports, [('dataflow_type', dataflow)])
                    self.assertEqual(connector.connect(profile), OK)
                    self.assertEqual(len(self.our_in.connector_profiles()), 1)
                    self.assertEqual(self.our_in.connect(Profile(ports, [], 'foreign', profile.id)), PRECONDITION_NOT_MET)
                    self.assertEqual(self.our_in.connect(Profile(ports)), PRECONDITION_NOT_MET)
                    self.assertEqual(len(self.our_in.connector_profiles()), 1)
                    last = connector.disconnect(profile.id)
                    self.assertEqual(last, OK)
                    self.expect_nothing_left()

    def test_our_pull_ports_ask_and_answer(self):
        self.assertEqual(self.our_out.connect(Profile([self.our_out.ior, self.into.ior], [('dataflow_type', 'pull')])), OK)
        self.assertEqual(self.into.fetch(), (BUFFER_EMPTY, b''))
        self.assertEqual(self.out.connect(Profile([self.out.ior, self.our_in.ior], [('dataflow_type', 'Pull ')])), OK)
        for payload in (b'one', b'two' * 1000):
            self.out.kept = sample(payload)
            self.assertTrue(eventually(lambda: self.into.fetch() == (PORT_OK, sample(payload))))

    def test_the_service_of_the_standard_carries_samples_too(self):
        service = ('interface_type', 'data_service')
        self.connect_both([service])
        self.assertEqual(self.echo(b'pushed'), sample(b'pushed'))
        self.our_in.disconnect_all()
        self.our_out.disconnect_all()
        self.connect_both([service, ('dataflow_type', 'pull')])
        self.out.kept = sample(b'pulled')
        self.assertTrue(eventually(lambda: self.into.fetch() == (PORT_OK, sample(b'pulled'))))

    def test_both_byte_orders_are_kept_as_agreed(self):
        self.connect_both([('serializer.cdr.endian', 'big,little')])
        self.assertEqual(self.echo(b'endian', '>'), sample(b'endian', '>'))

    def test_subscriptions_of_our_outport_deliver(self):
        for properties in ([('subscription_type', 'new')], [('subscription_type', 'New'), ('publisher.push_policy', 'fifo')],
                           [('io_mode', 'nonblock')], [('subscription_type', 'periodic'), ('push_rate', '500')],
                           [('subscription_type', 'Periodic'), ('publisher.push_rate', '500'), ('publisher.push_policy', 'all')]):
            self.connect_both(properties)
            self.assertEqual(self.echo(b'x' * 10), sample(b'x' * 10), properties)
            self.our_in.disconnect_all()
            self.our_out.disconnect_all()
            self.expect_nothing_left()

    def test_publishers_choose_by_their_policy(self):
        for policy, expected in (('all', range(20)), ('fifo', range(20)), ('skip', range(1, 20, 2))):
            self.connect_both([('subscription_type', 'new'), ('buffer.length', '64'), ('publisher.push_policy', policy),
                               ('publisher.skip_count', '1')])
            self.into.received.clear()
            for number in range(20):
                self.assertEqual(self.out.write(sample(bytes([number]))), PORT_OK)
            wanted = [sample(bytes([number])) for number in expected]
            self.assertTrue(eventually(lambda: len(self.into.received) >= len(wanted)))
            self.assertEqual(self.into.received, wanted, policy)
            self.our_in.disconnect_all()
            self.our_out.disconnect_all()

    def test_an_empty_pull_outport_answers_by_its_policy(self):
        self.assertEqual(self.out.connect(Profile([self.out.ior, self.our_in.ior])), OK)
        for policy, again in (('readback', PORT_OK), ('do_nothing', BUFFER_EMPTY), ('block', BUFFER_TIMEOUT)):
            self.assertEqual(self.our_out.connect(Profile([self.our_out.ior, self.into.ior],
                                                          [('dataflow_type', 'pull'), ('outport.buffer.read.empty_policy', policy),
                                                           ('outport.buffer.read.timeout', '0.05')])), OK)
            self.assertEqual(self.into.fetch()[0], BUFFER_TIMEOUT if policy == 'block' else BUFFER_EMPTY)
            self.assertEqual(self.out.write(sample(b'x')), PORT_OK)
            self.assertTrue(eventually(lambda: self.into.fetch() == (PORT_OK, sample(b'x'))))
            self.assertEqual(self.into.fetch()[0], again, policy)
            self.our_out.disconnect_all()

    def test_values_of_other_types_are_read_or_skipped(self):
        forth = Profile([self.out.ior, self.our_in.ior], [('buffer.length', (5, 3)), ('publisher.push_rate', (7, 1.5))])
        forth.set('dataport.dataflow_type', Alias('push'))
        self.assertEqual(self.our_in.connect(forth), OK)
        self.assertEqual(forth.get('dataport.buffer.length'), (5, 3))
        self.assertEqual(self.out.write(sample(b'')), PORT_OK)

    def test_references_of_an_earlier_life_do_not_count(self):
        # As a tool sends back what it has saved.
        for interface, names in NAMES.items():
            stale = Ior.make(names[0], '127.0.0.1', 1, b'gone', 2)
            properties = [('interface_type', interface), (interface + '.inport_ior', str(stale)), (interface + '.inport_ref', stale)]
            self.assertEqual(self.into.connect(Profile([self.into.ior, self.our_out.ior], properties)), OK)
            forth = Profile([self.our_in.ior, self.out.ior], properties)
            self.assertEqual(self.out.connect(forth), OK)
            for key in ('inport_ior', 'inport_ref'):
                values = [str(value) for name, value in forth.properties if name == 'dataport.%s.%s' % (interface, key)]
                self.assertEqual(len(values), 1, key)
                self.assertNotEqual(values[0], str(stale), key)
            self.assertEqual(self.echo(b'alive'), sample(b'alive'))
            self.our_in.disconnect_all()
            self.our_out.disconnect_all()
            self.expect_nothing_left()

    def test_refusals_have_their_codes(self):
        def code(*properties):
            return self.our_in.connect(Profile([self.our_in.ior, self.out.ior], properties))

        self.assertEqual(code(('interface_type', 'corba_cdr,direct')), BAD_PARAMETER)
        self.assertEqual(code(('interface_type', '')), BAD_PARAMETER)
        self.assertEqual(code(('dataflow_type', '')), BAD_PARAMETER)
        self.assertEqual(code(('serializer.cdr.endian', 'middle')), UNSUPPORTED)
        self.assertEqual(code(('data_type', 'IDL:RTC/TimedLong:1.0')), BAD_PARAMETER)
        self.assertEqual(self.our_in.connect(Profile([self.out.ior])), BAD_PARAMETER)
        self.assertEqual(self.our_in.connect(Profile([self.our_in.ior, None])), BAD_PARAMETER)
        for operation in ('disconnect', 'notify_disconnect'):
            self.assertEqual(self.our_in.by_id(operation, 'unknown'), BAD_PARAMETER)
        self.expect_nothing_left()

    def test_a_connection_that_fails_is_taken_back_on_both_sides(self):
        # What the foreign InPort gives is no object of shared_memory, which our OutPort finds out at the end of the chain.
        back = Profile([self.into.ior, self.our_out.ior], [('interface_type', 'shared_memory')])
        self.assertEqual(self.into.connect(back), ERROR)
        self.assertTrue(eventually(lambda: not self.our_out.connector_profiles()))
        self.expect_nothing_left()

    def test_both_sides_at_once_end_with_at_most_one_connection(self):
        for _ in range(10):
            codes = []
            ends = [threading.Thread(target=lambda: codes.append(self.out.connect(Profile([self.out.ior, self.our_in.ior])))),
                    threading.Thread(target=lambda: codes.append(self.our_in.connect(Profile([self.our_in.ior, self.out.ior]))))]
            for end in ends:
                end.start()
            for end in ends:
                end.join()
            left = self.our_in.connector_profiles()
            self.assertEqual(len(left), codes.count(OK), codes)
            self.assertLessEqual(len(left), 1)
            for profile in left:
                self.assertEqual(self.our_in.disconnect(profile.id), OK)
            self.expect_nothing_left()

    def test_a_receiver_that_is_full_keeps_its_connection(self):
        self.connect_both()
        self.into.answers = BUFFER_FULL
        for sent in (1, 2):
            self.assertEqual(self.out.write(sample(b'lost')), PORT_OK)
            self.assertTrue(eventually(lambda: len(self.into.refused) == sent))
        self.into.answers = PORT_OK
        self.assertEqual(self.echo(b'late'), sample(b'late'))
        self.assertEqual(len(self.our_out.connector_profiles()), 1)

    def test_an_answer_that_is_no_status_is_an_error(self):
        self.connect_both()
        self.into.answers = 77
        self.assertEqual(self.out.write(sample(b'lost')), PORT_OK)
        self.assertTrue(eventually(lambda: self.into.refused))
        self.into.answers = PORT_OK
        self.assertEqual(self.echo(b'late'), sample(b'late'))

    def test_a_connection_closed_once_by_the_peer_costs_no_sample(self):
        self.connect_both()
        self.echo(b'first')
        self.orb.close_after_request = 1
        self.into.received.clear()
        (target, _), = self.out.targets.values()
        # Through an ORB of its own, as it is the other one that closes.
        Orb(self.version, self.order).invoke(target, 'put', lambda out: out.octets(sample(b'second')))
        self.assertTrue(eventually(lambda: self.into.received == [sample(b'second')]))
        self.assertEqual(len(self.our_out.connector_profiles()), 1)

    def test_connections_to_a_process_that_died_are_found_without_writing(self):
        self.connect_both()
        watched = Orb(self.version, self.order)
        self.orb.stop()
        for port in (self.our_in, self.our_out):
            self.assertTrue(eventually(lambda: not Connected(watched, port.ior).connector_profiles()))

    def test_octets_that_are_no_protocol_harm_nobody(self):
        self.connect_both()
        (target, _), = self.out.targets.values()
        host, port, key = target.address()
        lie = Out('>', bytes(12))
        for value in (1, 0x03000000):
            lie.ulong(value)
        lie.ulong(0)
        lie.octets(key)
        lie.string('put')
        lie.ulong(0)
        lie.align(8)
        for length in (0xffffffff, 0x7fffffff, 1000):
            cut = bytes(lie.data) + struct.pack('>I', length) + bytes(20)
            message = b'GIOP\x01\x02\x00\x00' + struct.pack('>I', len(cut) - 12) + cut[12:]
            for octets in (message, message[:30], os.urandom(2000), b'GIOP\x01\x02\x01\x00\xff\xff\xff\xff', b''):
                with socket.create_connection((host, port)) as stream:
                    try:
                        stream.sendall(octets)
                    except OSError:
                        pass  # closed already
        for size in (0, 3, 11):
            self.assertEqual(self.out.write(b'\xff' * size), PORT_ERROR)
        self.assertEqual(self.echo(b'still here'), sample(b'still here'))


class Giop10(Foreign):
    version, order = 0, '>'


class LittleEndian(Foreign):
    version, order = 2, '<'


if __name__ == '__main__':
    peer_program = sys.argv.pop(1)
    unittest.main()

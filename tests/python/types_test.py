# Values of Python in the encoding of the wire: every data type of the product, the laxer inputs, and what is refused.
import json
import pathlib
import random
import struct
import sys

import numpy
import omniORB
import OpenRTM_aist  # noqa: F401
import pytest
import RTC
from omniORB import CORBA, any as any_, tcInternal

CORBA.ORB_init(["test"])  # wide text needs its code sets
payloads = json.loads((pathlib.Path(__file__).resolve().parents[1] / "golden" / "cdr_payloads.json").read_text())


# The Python value of a JSON one, by the type's descriptor.
def made(descriptor, value):
    if isinstance(descriptor, tuple):
        kind = descriptor[0]
        if kind == tcInternal.tv_alias:
            return made(descriptor[3], value)
        if kind == tcInternal.tv_struct:
            return descriptor[1](*[made(one, value[name]) for name, one in zip(descriptor[4::2], descriptor[5::2])])
        if kind == tcInternal.tv_enum:
            return descriptor[3][value] if isinstance(value, int) else next(one for one in descriptor[3] if one._n == value)
        if kind in (tcInternal.tv_sequence, tcInternal.tv_array):
            if tcInternal.unaliased(descriptor[1]) == tcInternal.tv_octet:
                return bytes(value)
            if tcInternal.unaliased(descriptor[1]) == tcInternal.tv_char:
                return "".join(one if isinstance(one, str) else chr(one) for one in value)
            return [made(descriptor[1], one) for one in value]
    if descriptor == tcInternal.tv_char and isinstance(value, int):
        return chr(value)
    return value


def same(one, two):
    if hasattr(one, "_members"):
        return all(same(getattr(one, name), getattr(two, name)) for name in one._members())
    if isinstance(one, list):
        return len(one) == len(two) and all(same(a, b) for a, b in zip(one, two))
    return one == two or (isinstance(one, float) and abs(one - two) <= 1e-6 * abs(two))


@pytest.mark.parametrize("payload", payloads, ids=lambda one: one["type"])
@pytest.mark.parametrize("order", ["little", "big"])
def test_the_octets_of_every_data_type_equal_those_of_cpp(payload, order):
    descriptor = omniORB.findType(payload["type"])
    assert descriptor is not None
    value = made(descriptor, payload["value"])
    golden = bytes.fromhex(payload[order + "_endian"])
    written = omniORB.cdrMarshal(tcInternal.TypeCode(payload["type"]), value, order == "little")
    assert len(written) == len(golden)
    # Octets that align members are zero here, and anything there.
    assert all(a == b or a == 0 for a, b in zip(written, golden))
    read = omniORB.cdrUnmarshal(tcInternal.TypeCode(payload["type"]), golden, order == "little")
    assert same(read, value), (read, value)
    assert omniORB.cdrMarshal(tcInternal.TypeCode(payload["type"]), read, order == "little") == written


def round_trip(value):
    code = tcInternal.TypeCode(value._NP_RepositoryId)
    return omniORB.cdrUnmarshal(code, omniORB.cdrMarshal(code, value, True), True)


stamp = RTC.Time(1, 2)


@pytest.mark.parametrize("value, read", [
    (RTC.TimedDoubleSeq(stamp, numpy.array([1.0, 2.0])), [1.0, 2.0]),
    (RTC.TimedDoubleSeq(stamp, numpy.array([1.5, 2.5], dtype=numpy.float32)), [1.5, 2.5]),
    (RTC.TimedDoubleSeq(stamp, numpy.arange(6.0)[::2]), [0.0, 2.0, 4.0]),
    (RTC.TimedFloatSeq(stamp, (1, 2)), [1.0, 2.0]),
    (RTC.TimedLongSeq(stamp, range(3)), [0, 1, 2]),
    (RTC.TimedLongSeq(stamp, numpy.array([7, 8])), [7, 8]),
    (RTC.TimedLong(stamp, numpy.int64(5)), 5),
    (RTC.TimedDouble(stamp, numpy.float32(0.5)), 0.5),
    (RTC.TimedOctetSeq(stamp, bytearray(b"ab")), b"ab"),
    (RTC.TimedOctetSeq(stamp, memoryview(b"ab")), b"ab"),
    (RTC.TimedOctetSeq(stamp, []), b""),
    (RTC.TimedBooleanSeq(stamp, [1, 0, "x"]), [True, False, True]),
    (RTC.TimedString(stamp, "Grüße"), "Grüße"),
    (RTC.TimedString(stamp, "\u65e5\u672c"), "\u65e5\u672c"),
    (RTC.TimedWString(stamp, "\u65e5\u672c\U0001F600"), "\u65e5\u672c\U0001F600"),
    (RTC.TimedCharSeq(stamp, "abc"), "abc"),
])
def test_what_python_users_assign_is_encoded(value, read):
    assert round_trip(value).data == read


@pytest.mark.parametrize("value, why", [
    (RTC.TimedLong(stamp, 3.0), "data: expected long, got float 3.0"),
    (RTC.TimedLong(stamp, 2 ** 31), "data: expected long, got int 2147483648"),
    (RTC.TimedLong(stamp, None), "data: expected long, got NoneType"),
    (RTC.TimedOctet(stamp, 256), "data: expected octet, got int 256"),
    (RTC.TimedDoubleSeq(stamp, "1,2"), "data: expected sequence<double>, got str '1,2'"),
    (RTC.TimedDoubleSeq(stamp, [1.0, None]), "data[1]: expected double, got NoneType"),
    (RTC.TimedString(stamp, b"octets"), "data: expected string, got bytes"),
    (RTC.TimedString(stamp, "a\0b"), "without the character 0"),
    (RTC.TimedPose2D(stamp, RTC.Pose2D(RTC.Point2D(1, "x"), 0)), "data.position.y: expected double, got str 'x'"),
    (RTC.TimedPose2D(stamp, 7), "data: expected RTC/Pose2D, got int 7, which has no member position"),
])
def test_a_value_that_does_not_fit_is_named_with_its_place_and_types(value, why):
    with pytest.raises(CORBA.BAD_PARAM) as raised:
        omniORB.cdrMarshal(tcInternal.TypeCode(value._NP_RepositoryId), value, True)
    assert why in str(raised.value)


def test_octets_that_are_cut_off_are_a_marshal_exception():
    whole = omniORB.cdrMarshal(RTC._tc_TimedDoubleSeq, RTC.TimedDoubleSeq(stamp, [1.0, 2.0]), True)
    for size in range(len(whole)):
        with pytest.raises(CORBA.MARSHAL):
            omniORB.cdrUnmarshal(RTC._tc_TimedDoubleSeq, whole[:size], True)


def test_a_wide_text_is_utf_16_with_its_byte_order_mark():
    assert omniORB.cdrMarshal(CORBA.TC_wstring, "\u65e5\u672c", True).hex() == "06000000fffee5652c67"


@pytest.mark.parametrize("value", [1, -5, 2 ** 40, "text", 2.5, True, b"abc", [1, 2], ["a", "b"], [1, "a"], {"a": 1, "b": [1.5]}])
def test_plain_values_survive_an_any(value):
    octets = omniORB.cdrMarshal(CORBA.TC_any, any_.to_any(value), True)
    assert any_.from_any(omniORB.cdrUnmarshal(CORBA.TC_any, octets, True)) == value


def test_structures_and_enumerators_survive_an_any():
    for value in (RTC.TimedLong(stamp, 3), RTC.INACTIVE_STATE):
        octets = omniORB.cdrMarshal(CORBA.TC_any, any_.to_any(value), True)
        read = any_.from_any(omniORB.cdrUnmarshal(CORBA.TC_any, octets, True), keep_structs=True)
        assert repr(read) == repr(value)


# A port has the type code of its data, and an any takes it along; default and repeated labels, all kinds of discriminators.
@pytest.mark.parametrize("number, declared, value", [
    (1, "union U switch (long) { case 0: long seeds; case 1: case 2: string meat; default: boolean none; };", (2, "worm")),
    (2, "union U switch (long) { case 0: long seeds; default: boolean none; };", (7, True)),
    (3, "enum K { BIRD, FISH }; union U switch (K) { case BIRD: long seeds; case FISH: string meat; };", ("FISH", "worm")),
    (4, "union U switch (boolean) { case TRUE: sequence<double> seeds; };", (True, [1.5])),
    (5, "union U switch (char) { case 'a': long seeds; case 'b': string meat; };", ("b", "worm")),
])
def test_unions_are_in_data_of_ports_and_in_anys(number, declared, value):
    name = f"Fed{number}"
    omniORB.importIDLString(f"module {name} {{ struct Time {{ long sec; }}; {declared} struct Timed {{ Time tm; U food; }}; }};")
    module = __import__(name)
    discriminator = getattr(module, value[0]) if hasattr(module, str(value[0])) else value[0]
    data = module.Timed(module.Time(1), module.U(discriminator, value[1]))
    assert OpenRTM_aist.OutPort("out", data).getPortDataType() == f"IDL:{name}/Timed:1.0"
    octets = omniORB.cdrMarshal(CORBA.TC_any, any_.to_any(data), True)
    read = any_.from_any(omniORB.cdrUnmarshal(CORBA.TC_any, octets, True), keep_structs=True)
    assert (read.food._d, read.food._v) == (discriminator, value[1])


def test_default_values_are_those_of_the_original():
    assert OpenRTM_aist.instantiateDataType(RTC.TimedPose2D).data.position.x == 0.0
    assert OpenRTM_aist.instantiateDataType(RTC.TimedOctetSeq).data == []
    assert OpenRTM_aist.instantiateDataType(RTC.TimedString).data == ""
    assert isinstance(RTC._d_TimedLong, tuple) and (len(RTC._d_TimedLong) - 4) % 2 == 0
    assert RTC.TimedLong(*([None] * ((len(RTC._d_TimedLong) - 4) // 2))).data is None


def test_an_unknown_name_says_that_it_is_not_there():
    for module, name in ((OpenRTM_aist, "NoSuchThing"), (CORBA, "NoSuchThing")):
        with pytest.raises(AttributeError, match="not part of this implementation"):
            getattr(module, name)


def test_the_types_of_values_in_anys_are_not_kept_for_each_value():
    for value in ("text", [1, 2], {"a": 1}, [["a"]]):
        octets = omniORB.cdrMarshal(CORBA.TC_any, any_.to_any(value), True)
        first, second = (omniORB.cdrUnmarshal(CORBA.TC_any, octets, True) for _ in range(2))
        assert any_.from_any(first) == any_.from_any(second) == value
        count = sys.getrefcount(second.typecode()._d)  # outside of the assertion, which keeps references to its operands
        assert count == 2, "the attribute and the argument"


# Peers can send such type codes: each raises an exception, and the process continues.
@pytest.mark.parametrize("octets", [struct.pack("<I", 11) * 100000 + bytes(4), struct.pack("<III", 19, 0xffffffff, 1), struct.pack("<II", 29, 0),
                                    struct.pack("<II", 0xffffffff, 0xfffffffc), struct.pack("<IIIIc", 18, 0, 0xffffffff, 0, b"x")])
def test_hostile_anys_are_refused(octets):
    with pytest.raises((RecursionError, CORBA.MARSHAL)):
        omniORB.cdrUnmarshal(CORBA.TC_any, octets, True)


def test_type_codes_with_wrong_octets_are_values_or_exceptions():
    chance = random.Random(7)
    numbers = [struct.pack("<I", one) for one in (0, 1, 2, 11, *range(13, 23), 27, 29, 30, 33, 0x7fffffff, 0x80000000, 0xfffffff0, 0xffffffff)]
    codes = [omniORB.cdrMarshal(CORBA.TC_TypeCode, getattr(RTC, "_tc_" + name), True)
             for name in ("TimedLong", "CameraImage", "ReturnCode_t", "ComponentProfile", "RTObject", "TimedWString")]
    for _ in range(4000):
        octets = bytearray(chance.choice(codes))
        for _ in range(chance.randrange(1, 4)):
            at = chance.randrange(len(octets) - 3) & ~3
            octets[at:at + 4] = chance.choice(numbers)
            octets[chance.randrange(len(octets))] = chance.randrange(256)
        for kind, rest in ((CORBA.TC_TypeCode, b""), (CORBA.TC_any, b"\1" * 64)):
            try:
                omniORB.cdrUnmarshal(kind, bytes(octets) + rest, True)
            except (CORBA.MARSHAL, TypeError, ValueError):
                pass


def test_values_inside_themselves_are_refused():
    circle = CORBA.Any(CORBA.TC_any, None)
    circle._v = circle
    with pytest.raises(RecursionError):
        omniORB.cdrMarshal(CORBA.TC_any, circle, True)
    nested = 3
    for _ in range(100000):
        nested = (19, nested, 0)
    with pytest.raises((RecursionError, TypeError)):
        omniORB.cdrMarshal(nested, [], True)


def test_what_is_no_sequence_is_no_sequence_of_idl():
    def endless():
        while True:
            yield 1

    for value in (endless(), iter([1]), {1, 2}, range(1 << 40)):
        with pytest.raises(CORBA.BAD_PARAM, match=r"data: expected sequence<long>, got"):
            omniORB.cdrMarshal(RTC._tc_TimedLongSeq, RTC.TimedLongSeq(stamp, value), True)

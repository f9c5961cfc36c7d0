# Which reports count (no_report.py).
import unittest

from no_report import is_known

head = """=================================================================
==rtcd==7==ERROR: LeakSanitizer: detected memory leaks

"""
reference = """Direct leak of 160 byte(s) in 4 object(s) allocated from:
    #0 0x7f8676ab94c8 in operator new(unsigned long) ../../../../src/libsanitizer/asan/asan_new_delete.cpp:95
    #1 0x7f86771ac958 in omniObjRef::_unMarshal(char const*, cdrStream&) (/lib/libomniORB4.so.2+0xe9958)
    #2 0x7f866f6a2498 in RTC::PortService::_unmarshalObjRef(cdrStream&) include/rtm/idl/RTC.hh:3296

"""
ours = """Direct leak of 40 byte(s) in 1 object(s) allocated from:
    #0 0x7f8676ab94c8 in operator new(unsigned long) ../../../../src/libsanitizer/asan/asan_new_delete.cpp:95
    #1 0x7f866f6a2498 in RTC::PortService::_unmarshalObjRef(cdrStream&) include/rtm/idl/RTC.hh:3296
    #2 0x7f86771ac958 in omniObjRef::_unMarshal(char const*, cdrStream&) (/lib/libomniORB4.so.2+0xe9958)

"""
text = """Direct leak of 10 byte(s) in 1 object(s) allocated from:
    #0 0x7f8c47eb9628 in operator new[](unsigned long) ../../../../src/libsanitizer/asan/asan_new_delete.cpp:98
    #1 0x7f8c42907598 in cdrStream::unmarshalRawString() (/lib/x86_64-linux-gnu/libomniORB4.so.2+0xc5598)

"""
connection = """Direct leak of 432 byte(s) in 1 object(s) allocated from:
    #0 0x7f8c47eb94c8 in operator new(unsigned long) ../../../../src/libsanitizer/asan/asan_new_delete.cpp:95
    #1 0x7f8c4295430a in omni::giopStrand::acquireServer(omni::giopWorker*) (/lib/x86_64-linux-gnu/libomniORB4.so.2+0x11230a)

"""
tls = """Direct leak of 904 byte(s) in 1 object(s) allocated from:
    #0 0x7fb49bab89cf in __interceptor_malloc ../../../../src/libsanitizer/asan/asan_malloc_linux.cpp:69
    #1 0x7fb492e333e8 in CRYPTO_zalloc (/lib/x86_64-linux-gnu/libcrypto.so.3+0x2333e8)

"""
picture = """Direct leak of 16 byte(s) in 1 object(s) allocated from:
    #0 0x7f75496b83b7 in __interceptor_calloc ../../../../src/libsanitizer/asan/asan_malloc_linux.cpp:77
    #1 0x7f75452b81de  (/lib/x86_64-linux-gnu/libOSMesa.so.8+0xb81de)

"""
context = """Direct leak of 16 byte(s) in 1 object(s) allocated from:
    #0 0x7f75496b83b7 in __interceptor_calloc ../../../../src/libsanitizer/asan/asan_malloc_linux.cpp:77
    #1 0x7f75452b81de in OSMesaCreateContextAttribs (/lib/x86_64-linux-gnu/libOSMesa.so.8+0xb81de)

"""
reached = """Indirect leak of 8224 byte(s) in 1 object(s) allocated from:
    #0 0x7f8c47eb9628 in operator new[](unsigned long) ../../../../src/libsanitizer/asan/asan_new_delete.cpp:98
    #1 0x7f866f6a2498 in ours() ours.cpp:1

"""


class Reports(unittest.TestCase):
    def test_of_known_leaks_do_not_count(self):
        for leaks in (reference, text, connection, tls, picture, reference + picture + reached):
            self.assertTrue(is_known(head + leaks), leaks)

    def test_of_others_count(self):
        for leaks in (ours, context, reference + ours, ours + reference, reached, ""):
            self.assertFalse(is_known(head + leaks), leaks)

    def test_of_what_is_no_leak_count(self):
        self.assertFalse(is_known("==1==ERROR: AddressSanitizer: heap-use-after-free\n" + reference))
        self.assertFalse(is_known(head + reference + "==1==ERROR: AddressSanitizer: SEGV\n"))
        self.assertFalse(is_known("WARNING: ThreadSanitizer: data race\n"))
        self.assertFalse(is_known("any.cpp:3:7: runtime error: signed integer overflow\n" + head + reference))
        self.assertFalse(is_known(""))


unittest.main()

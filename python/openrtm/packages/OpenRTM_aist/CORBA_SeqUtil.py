"""Helpers for IDL sequences, which are lists."""


def for_each(seq, function):
    for one in seq:
        function(one)
    return function


def find(seq, predicate):
    for number, one in enumerate(seq):
        if predicate(one):
            return number
    return -1


def push_back(seq, value):
    seq.append(value)


def push_back_list(seq, values):
    seq.extend(values)


def insert(seq, value, index):
    seq.insert(min(index, len(seq)), value)


def front(seq):
    return seq[0]


def back(seq):
    return seq[-1]


def erase(seq, index):
    if index <= len(seq) - 1:
        del seq[index]


def erase_if(seq, predicate):
    at = find(seq, predicate)
    if at >= 0:
        del seq[at]


def clear(seq):
    del seq[:]


def refToVstring(objects):
    from omniORB import CORBA
    return [CORBA.ORB_init().object_to_string(one) for one in objects]

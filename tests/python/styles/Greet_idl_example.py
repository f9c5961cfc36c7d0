#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-

"""
 \file Greet_idl_example.py
 \brief Python example implementations generated from Greet.idl
"""

import CORBA, PortableServer
import _GlobalIDL, _GlobalIDL__POA


class Greet_i (_GlobalIDL__POA.Greet):
    """
    \class Greet_i
    Example class implementing IDL interface Greet
    """

    def __init__(self):
        """
        \brief standard constructor
        Initialise member variables here
        """
        pass

    # string hello(in string name, in Mood mood)
    def hello(self, name, mood):
        return "hello " + name + " " + mood.name

    # Moods all(out long n)
    def all(self):
        raise CORBA.NO_IMPLEMENT(0, CORBA.COMPLETED_NO)
        # *** Implement me
        # Must return: result, n


if __name__ == "__main__":
    import sys

    # Initialise the ORB
    orb = CORBA.ORB_init(sys.argv)

    # As an example, we activate an object in the Root POA
    poa = orb.resolve_initial_references("RootPOA")

    # Create an instance of a servant class
    servant = Greet_i()

    # Activate it in the Root POA
    poa.activate_object(servant)

    # Get the object reference to the object
    objref = servant._this()

    # Print a stringified IOR for it
    print(orb.object_to_string(objref))

    # Activate the Root POA's manager
    poa._get_the_POAManager().activate()

    # Run the ORB, blocking this thread
    orb.run()

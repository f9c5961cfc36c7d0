"""Prints the reference of a servant, and serves until it is told to end."""
import sys

from omniORB import CORBA

from counter import Counter_i

orb = CORBA.ORB_init(sys.argv)
poa = orb.resolve_initial_references("RootPOA")
servant = Counter_i()
poa.activate_object(servant)
poa._get_the_POAManager().activate()
print(orb.object_to_string(servant._this()), flush=True)
orb.run()

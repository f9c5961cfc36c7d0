"""The program that `rtcd X.py` becomes: python3 -m OpenRTM_aist.rtcd OPTIONS -- MODULES."""
import sys

from OpenRTM_aist import host

sys.exit(host.main(sys.argv))

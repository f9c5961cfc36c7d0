"""Only a manager: what it creates is in its configuration."""
import sys

import OpenRTM_aist

if __name__ == "__main__":
    manager = OpenRTM_aist.Manager.init(sys.argv)
    manager.activateManager()
    manager.runManager()

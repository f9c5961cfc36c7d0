"""The minor codes of the ORB, as TRANSIENT_ConnectFailed. All are names of the package omniORB, too."""
import _openrtm_core as _core

globals().update(_core.minor_codes())

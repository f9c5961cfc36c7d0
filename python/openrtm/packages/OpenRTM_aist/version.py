"""The version of OpenRTM-aist-Python whose API this is."""
openrtm_name = "OpenRTM-aist-2.1"
openrtm_version = "2.1.0"
corba_name = "omniORB"

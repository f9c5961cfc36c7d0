"""The parts of the back end `python` of omniidl."""

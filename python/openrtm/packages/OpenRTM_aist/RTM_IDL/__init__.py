"""For sources that import it: the stubs of the IDL files are modules of their own."""

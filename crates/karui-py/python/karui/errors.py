"""What Karui raises."""


class KaruiError(Exception):
    """Any error of Karui."""


class InputError(KaruiError, ValueError):
    """A mesh, an option or the content of a file is not what it must be."""


class FileError(KaruiError, OSError):
    """A file could not be read or written. Nothing half-written is left behind."""


class Cancelled(KaruiError):
    """A `progress` callback returned False."""

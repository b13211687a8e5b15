"""An S3 server on this machine, with an empty bucket."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from unittest import mock

from moto.server import ThreadedMotoServer
from obstore.store import S3Store

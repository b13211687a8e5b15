"""From archive files to the lake: samples, blocks and the frames that methods work on."""

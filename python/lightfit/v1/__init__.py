"""The messages of lightfit.v1, generated from proto/lightfit/v1: `from lightfit.v1 import result_pb2`."""

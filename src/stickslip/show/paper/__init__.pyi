from .reproduction import Reproduction as Reproduction, reproduce as reproduce

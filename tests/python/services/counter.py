"""A servant of Shop::Counter, for tests."""
import Shop
import Shop__POA


class Counter_i(Shop__POA.Counter):
    def __init__(self):
        self.sign = "open"
        self.rings = 0

    def _get_visits(self):
        return self.rings

    def _get_sign(self):
        return self.sign

    def _set_sign(self, value):
        self.sign = value

    def buy(self, name, count):
        if name == "gone":
            raise Shop.Sold(name, 3)
        if name == "broken":
            raise ValueError("the till does not open")
        if name == "nothing":
            return None
        return Shop.Item(name, 1.5, Shop.green, [1, 2, 3]), count - 1, True

    def list(self):
        return [Shop.Item("apple", 1, Shop.red, [])] * 3

    def ring(self, times):
        self.rings += times

    def value(self, wanted):
        return Shop.Price(text="much") if wanted._d == 1 else wanted

    def echo(self, value):
        return value

    def wide(self, text):
        return text + "\u65e5\u672c"

    def itself(self):
        return self._this()

    def other(self):
        return None

// The way to the server: of each kind of question the newest counts, and a lost connection is taken up again.
const PATIENCE = 4000;

// An answer: header as an object, its arrays by name.
export function unpacked(buffer) {
  const size = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size)));
  let offset = 4 + size;
  const arrays = {};
  for (const [name, count] of header.arrays) {
    arrays[name] = new Float32Array(buffer, offset, count);
    offset += 4 * count;
  }
  return { header, arrays };
}

export class Link {
  constructor(onAnswer, onState) {
    Object.assign(this, { onAnswer, onState, id: 0, wait: 250, asked: {}, queue: [], busy: null });
    this.open();
  }

  open() {
    const address = new URL("socket", location.href.split("#")[0].split("?")[0]);
    address.protocol = address.protocol.replace("http", "ws");
    const socket = (this.socket = new WebSocket(address));
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.wait = 250;
      this.busy = null;
      this.queue = [];
      this.onState("open");
      for (const [channel, body] of Object.entries(this.asked)) this.send(channel, body);
    };
    socket.onmessage = (event) => this.take(unpacked(event.data));
    socket.onclose = () => {
      this.onState("lost");
      setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(2 * this.wait, 4000);
    };
  }

  // Ask. Curves are asked for one at a time, so that a fast hand does not run ahead of the answers. Maps, strips, and the long run of a
  // slider that rested are replaced by what is asked next; a long run waits for the short one before it.
  ask(channel, body) {
    this.asked[channel] = body;
    if (channel !== "curves") return this.send(channel, body);
    this.queue = body.fine ? [...this.queue.filter((other) => !other.fine), body] : [body];
    this.next();
  }

  next() {
    const waits = this.busy && performance.now() - this.busy.since < PATIENCE && (!this.busy.fine || this.queue[0]?.fine);
    if (!waits && this.queue.length) this.send("curves", this.queue.shift());
  }

  send(channel, body) {
    if (this.socket.readyState !== WebSocket.OPEN) return;
    const id = ++this.id;
    if (channel === "curves") this.busy = { id, fine: body.fine, since: performance.now() };
    this.socket.send(JSON.stringify({ ...body, channel, id }));
  }

  take(answer) {
    if (this.busy?.id === answer.header.id) {
      this.busy = null;
      this.next();
    }
    this.onAnswer(answer);
  }
}

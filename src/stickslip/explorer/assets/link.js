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
    Object.assign(this, { onAnswer, onState, id: 0, wait: 250, asked: {}, busy: {}, next: {} });
    this.open();
  }

  open() {
    const address = new URL("socket", location.href.split("#")[0].split("?")[0]);
    address.protocol = address.protocol.replace("http", "ws");
    const socket = (this.socket = new WebSocket(address));
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.wait = 250;
      this.busy = {};
      this.next = {};
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

  // Ask. Curves are asked for one at a time, so that a fast hand does not run ahead of the answers; maps and strips replace each other.
  ask(channel, body) {
    this.asked[channel] = body;
    const busy = this.busy[channel];
    if (channel === "curves" && busy && performance.now() - busy < PATIENCE) this.next[channel] = body;
    else this.send(channel, body);
  }

  send(channel, body) {
    if (this.socket.readyState !== WebSocket.OPEN) return;
    this.busy[channel] = performance.now();
    this.socket.send(JSON.stringify({ ...body, channel, id: ++this.id }));
  }

  take(answer) {
    const channel = answer.header.channel ?? "curves";
    this.busy[channel] = 0;
    const next = this.next[channel];
    delete this.next[channel];
    if (next) this.send(channel, next);
    this.onAnswer(answer);
  }
}
